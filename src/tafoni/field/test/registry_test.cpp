// The same questions to every registered primitive and operator; a new one is covered without a new test.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/operator.h"
#include "tafoni/field/primitive.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/simd.h"

namespace tafoni::field {
namespace {

using testing::HasSubstr;

struct Sample {
  Vec3d anchor;
  float energy;
  std::vector<float> shape;
};

/// A primitive with parameters drawn well inside their ranges and a size of metres.
Sample draw(const PrimitiveType& type, Random& random) {
  Sample s{{random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-30, 30)},
           draw_float(random, -9, 9),
           {draw_float(random, 1.5, 8)}};
  const std::uint64_t groups = type.extras == 0 ? 0 : type.variable ? 1 + random.below(5) : 1;
  for (std::uint64_t i = 0; i < groups; ++i)
    for (const ParamInfo& p : std::span(type.about.params).subspan(1))
      s.shape.push_back(draw_float(random, std::max(p.min, -10.0), std::min(p.max, 10.0)));
  return s;
}

NodePtr cloud_of(const PrimitiveType& type, std::span<const Sample> samples, double noise) {
  CloudBuilder cloud({type.about.name, 7, {noise, 3, 2, 5}});
  for (const Sample& s : samples) cloud.add(s.anchor, s.energy, s.shape);
  return cloud.finish();
}

class Kinds : public testing::TestWithParam<const PrimitiveType*> {};

TEST_P(Kinds, DeclareThemselves) {
  const PrimitiveType& type = *GetParam();
  EXPECT_FALSE(type.about.doc.empty());
  EXPECT_FALSE(type.about.source.empty());
  ASSERT_FALSE(type.about.params.empty());
  EXPECT_EQ(type.about.params[0].name, "radius");
  EXPECT_EQ(std::ssize(type.about.params), 1 + type.extras);
  // A chain of vertices, relative to the first.
  if (type.variable) {
    EXPECT_EQ(type.extras, 3);
  }
  std::set<std::string> names;
  for (const ParamInfo& p : type.about.params) {
    EXPECT_TRUE(names.insert(p.name).second) << p.name;
    EXPECT_FALSE(p.doc.empty()) << p.name;
    EXPECT_LT(p.min, p.max) << p.name;
    EXPECT_NO_THROW(check_value(p, p.init, type.about.name));
    EXPECT_THAT(error_of([&] { check_value(p, Value(p.max * 2), type.about.name); }),
                HasSubstr(p.name + " = "));
    EXPECT_THAT(error_of([&] { check_value(p, Value(std::string("wide")), type.about.name); }),
                HasSubstr(p.name + " must be a number"));
    EXPECT_EQ(std::get<double>(parse_value(p, to_toml(p.init), type.about.name)), std::get<double>(p.init));
  }
}

TEST_P(Kinds, VanishExactlyOutsideTheirSupportAndNowhereElse) {
  const PrimitiveType& type = *GetParam();
  Random random(1);
  for (double noise : {0.0, 1.0}) {
    int inside = 0;
    for (int i = 0; i < 60; ++i) {
      const Sample s = draw(type, random);
      const NodePtr node = cloud_of(type, {&s, 1}, noise);
      const CompiledField field = compile(node);
      const double extent = type.extent(std::span(s.shape).subspan(1));
      const double reach = extent + s.shape[0] + noise + (type.volumetric ? 7 : 0);
      for (int k = 0; k < 60; ++k) {
        const Vec3d dir =
            normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
        const double d = random.uniform(0, 1.6) * reach;
        const float v = field.value(s.anchor + dir * d);
        if (d > reach * 1.0001 + 0.001) {
          EXPECT_EQ(v, 0.f);
        }
        EXPECT_LE(std::fabs(v), std::fabs(s.energy) * 1.0001f);
        if (v != 0) {
          EXPECT_EQ(v > 0, s.energy > 0);
        }
        inside += v != 0;
      }
    }
    EXPECT_GT(inside, 100);
  }
}

/// The nearest point of the skeleton, from the value and the gradient at p: g is inverted for the distance.
Vec3d skeleton_point(const PrimitiveType& type, const CompiledField& field, const Sample& s, Vec3d p) {
  float v;
  Vec3f g;
  field.gradients({&p, 1}, {&v, 1}, {&g, 1});
  const double q = std::sqrt(1 - std::cbrt(double{v / s.energy}));
  const double d = type.volumetric ? s.shape[0] + q * 7 : q * s.shape[0];
  const Vec3d inwards = normalized(to_double(g)) * (s.energy > 0 ? 1.0 : -1.0);
  return p + inwards * d;
}

TEST_P(Kinds, HaveTheirEnergyAtTheSkeleton) {
  const PrimitiveType& type = *GetParam();
  Random random(8);
  int tried = 0;
  for (int i = 0; i < 3000; ++i) {
    const Sample s = draw(type, random);
    const CompiledField field = compile(cloud_of(type, {&s, 1}, 0));
    const double size =
        0.8 * (s.shape[0] + type.extent(std::span(s.shape).subspan(1)) + (type.volumetric ? 7 : 0));
    const Vec3d p = s.anchor + Vec3d{random.uniform(-size, size), random.uniform(-size, size),
                                     random.uniform(-size, size)};
    const double share = field.value(p) / double{s.energy};
    if (share < 0.05 || share > 0.95) continue;
    ++tried;
    EXPECT_NEAR(field.value(skeleton_point(type, field, s, p)) / s.energy, 1, 1e-3);
  }
  EXPECT_GT(tried, 100);
}

TEST_P(Kinds, RefuseNumbersOutsideTheirRanges) {
  const PrimitiveType& type = *GetParam();
  Random random(9);
  for (std::size_t i = 0; i < type.about.params.size(); ++i) {
    Sample s = draw(type, random);
    CloudBuilder cloud({type.about.name, 7, {}});
    cloud.add(s.anchor, s.energy, s.shape);
    s.shape[i] = static_cast<float>(type.about.params[i].max * 20);
    EXPECT_THAT(error_of([&] { cloud.add(s.anchor, s.energy, s.shape); }),
                HasSubstr("a " + type.about.name + " primitive "))
        << type.about.params[i].name;
  }
}

TEST_P(Kinds, IntervalsEncloseSamples) {
  const PrimitiveType& type = *GetParam();
  Random random(2);
  for (double noise : {0.0, 1.0}) {
    std::vector<Sample> samples;
    for (int i = 0; i < 40; ++i) samples.push_back(draw(type, random));
    const CompiledField field = compile(cloud_of(type, samples, noise));
    for (int i = 0; i < 150; ++i) {
      const Vec3d c{random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-40, 40)};
      const Box3d box = Box3d{c, c}.grown(random.uniform(0.05, 10));
      const Interval range = field.interval(box);
      for (int k = 0; k < 30; ++k) {
        const float v = field.value({random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                                     random.uniform(box.lo.z, box.hi.z)});
        EXPECT_GE(v, range.lo);
        EXPECT_LE(v, range.hi);
      }
    }
  }
}

TEST_P(Kinds, IntervalsTightenWithTheBox) {
  const PrimitiveType& type = *GetParam();
  Random random(7);
  for (int i = 0; i < 30; ++i) {
    const Sample s = draw(type, random);
    const CompiledField field = compile(cloud_of(type, {&s, 1}, 0));
    const Vec3d p = s.anchor + Vec3d{random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-6, 6)};
    const Interval range = field.interval(Box3d{p, p}.grown(0.02));
    EXPECT_LT(range.hi - range.lo, 0.15f * std::fabs(s.energy));
  }
}

TEST_P(Kinds, GradientsMatchDifferences) {
  const PrimitiveType& type = *GetParam();
  Random random(3);
  for (double noise : {0.0, 0.8}) {
    std::vector<Sample> samples;
    for (int i = 0; i < 25; ++i) samples.push_back(draw(type, random));
    const CompiledField field = compile(cloud_of(type, samples, noise));
    int bad = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3d p{random.uniform(-35, 35), random.uniform(-35, 35), random.uniform(-35, 35)};
      float v;
      Vec3f g;
      field.gradients({&p, 1}, {&v, 1}, {&g, 1});
      EXPECT_EQ(v, field.value(p));
      const double h = 0.01;
      const auto slope = [&](Vec3d d) { return (field.value(p + d * h) - field.value(p - d * h)) / (2 * h); };
      const Vec3d d{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
      bad += length(d - to_double(g)) > 0.01 + 0.02 * length(d);
    }
    // Where the nearest point of a skeleton jumps, or on a ball's rim with its noise, there is no derivative.
    EXPECT_LE(bad, 6);
  }
}

std::string kind_name(const testing::TestParamInfo<const PrimitiveType*>& info) {
  std::string name = info.param->about.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Registry, Kinds, testing::ValuesIn(all_primitives().begin(), all_primitives().end()),
                         kind_name);

class Operators : public testing::TestWithParam<const OperatorType*> {};

TEST_P(Operators, DeclareThemselves) {
  const OperatorType& type = *GetParam();
  EXPECT_FALSE(type.about.doc.empty());
  EXPECT_FALSE(type.about.source.empty());
  if (type.combination) {
    EXPECT_LE(type.about.params.size(), 1u);
  } else {
    EXPECT_FALSE(type.about.params.empty());
    EXPECT_THAT(error_of([&] {
                  combine(type.about.name, {constant(1), constant(2)});
                }),
                HasSubstr("does not combine trees by value"));
  }
  for (const ParamInfo& p : type.about.params) {
    EXPECT_FALSE(p.doc.empty()) << p.name;
    EXPECT_LT(p.min, p.max) << p.name;
    EXPECT_NO_THROW(check_value(p, p.init, type.about.name));
  }
}

TEST_P(Operators, IntervalsAndNeedsAreHonest) {
  const OperatorType& type = *GetParam();
  if (!type.combination) return;  // operators_test asks this of trees
  const float parameter =
      type.about.params.empty() ? 0.f : static_cast<float>(std::get<double>(type.about.params.front().init));
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto range = [&] {
      const auto a = draw_float(random, -5, 5), b = draw_float(random, -5, 5);
      return Interval{std::min(a, b), std::max(a, b)};
    };
    const Interval a = range(), b = range(), r = type.combination->interval(a, b, parameter);
    const Needs needs = type.combination->needs(a, b, parameter);
    for (int k = 0; k < 10; ++k) {
      const auto va = draw_float(random, a.lo, a.hi), vb = draw_float(random, b.lo, b.hi);
      const float v = compile(combine(type.about.name, {constant(va), constant(vb)})).value({0, 0, 0});
      EXPECT_GE(v, r.lo);
      EXPECT_LE(v, r.hi);
      if (needs != Needs::both) {
        EXPECT_EQ(v, needs == Needs::first ? va : vb);
      }
    }
  }
}

std::string operator_name(const testing::TestParamInfo<const OperatorType*>& info) {
  return info.param->about.name;
}
INSTANTIATE_TEST_SUITE_P(Registry, Operators,
                         testing::ValuesIn(all_operators().begin(), all_operators().end()), operator_name);

/// One number for the bits of every kind's values and gradients over many points.
std::uint64_t field_hash() {
  Random random(4);
  std::vector<NodePtr> parts{constant(-7.5f)};
  for (const PrimitiveType* type : all_primitives())
    for (double noise : {0.0, 0.8}) {
      std::vector<Sample> samples;
      for (int i = 0; i < 30; ++i) samples.push_back(draw(*type, random));
      parts.push_back(cloud_of(*type, samples, noise));
    }
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(20, 20);
  heights->placement = {-50, 50, 5, 5};
  for (float& h : heights->values.values()) h = draw_float(random, -20, 20);
  const NodePtr land = unite({blend(parts), heightfield(heights, HeightfieldSettings{})});
  const std::vector<Placement> places{{{9, 4, 3}, 1, 0.5, 1.2}, {{-20, 4, 1}, -2, 0, 0.7}};
  const FunctionPtr control = as_function(parts[1]), resistance = as_function(parts[2]);
  const CompiledField field = compile(
      morph(blend({warp(erode(land, control, resistance, 3), control, {}), instances(parts[3], places)}),
            transform(land, places[0]), 0.3));
  std::vector<Vec3d> points(5000);
  for (Vec3d& p : points) p = {random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-40, 40)};
  std::vector<float> values(points.size());
  std::vector<Vec3f> gradients(points.size());
  field.gradients(points, values, gradients);
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (float v : {values[i], gradients[i].x, gradients[i].y, gradients[i].z})
      hash = hash_combine(hash, std::bit_cast<std::uint32_t>(v == 0 ? 0.f : v));
  return hash;
}

TEST(Simd, PrintsTheHashOfItsInstructionSet) {
  std::printf("SIMD %s HASH %016llx\n", simd_name().c_str(), static_cast<unsigned long long>(field_hash()));
}

std::string run_limited(const std::string& name) {
  // The shell's own /proc/self would be the shell: name this process.
  const std::string line = "TAFONI_SIMD=" + name + " $(readlink /proc/" + std::to_string(getpid()) +
                           "/exe) --gtest_filter=Simd.PrintsTheHashOfItsInstructionSet";
  std::FILE* pipe = popen(line.c_str(), "r");
  std::string all;
  char text[256];
  while (pipe && std::fgets(text, sizeof(text), pipe)) all += text;
  if (pipe) pclose(pipe);
  const auto at = all.find("SIMD ");
  return at == std::string::npos ? all : all.substr(at, all.find('\n', at) - at);
}

TEST(Simd, InstructionSetsAgree) {
  const std::string wide = run_limited("avx512"), avx2 = run_limited("avx2"), sse4 = run_limited("sse4"),
                    scalar = run_limited("scalar");
  const auto hash = [](const std::string& s) { return s.substr(s.find("HASH")); };
  if (avx2.find("SIMD avx2") == std::string::npos) GTEST_SKIP() << "this machine has no AVX2: " << avx2;
  EXPECT_EQ(hash(wide), hash(avx2)) << wide << " and " << avx2;
  ASSERT_NE(sse4.find("SIMD sse4"), std::string::npos) << sse4;
  ASSERT_NE(scalar.find("SIMD scalar"), std::string::npos) << scalar;
  // Neither fuses multiply and add: the same operations, one lane or four.
  EXPECT_EQ(hash(sse4), hash(scalar));
}

}  // namespace
}  // namespace tafoni::field
