// Operators that ask a tree elsewhere or take functions, alone and in one another: pruned evaluation equals
// point evaluation bit for bit, ranges enclose, gradients match differences, analytic truths hold.

#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/test/lattice.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/noise.h"

namespace tafoni::field {
namespace {

using testing::HasSubstr;

/// Noise in [0, 1] inside a box, fading to 0 over 8 m at its border; everywhere without a box.
class Patchy final : public Function {
 public:
  Patchy(Box3d box, double wavelength, std::uint64_t seed)
      : box_(box), wavelength_(wavelength), seed_(seed) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    std::vector<Vec3d> scaled;
    for (const Vec3d& p : points) scaled.push_back(p * (1 / wavelength_));
    fbm(scaled, 2, seed_, out);
    for (std::size_t i = 0; i < points.size(); ++i) out[i] *= fade(points[i]);
  }
  Interval range(const Box3d& box) const override {
    if (!box.overlaps(box_)) return {0, 0};
    return {0, 1};
  }
  Box3d support() const override { return box_; }
  double step() const override { return 0.005; }

 private:
  float fade(Vec3d p) const {
    const double d = std::min({p.x - box_.lo.x, box_.hi.x - p.x, p.y - box_.lo.y, box_.hi.y - p.y,
                               p.z - box_.lo.z, box_.hi.z - p.z});
    return static_cast<float>(std::clamp(d / 8, 0.0, 1.0));
  }
  Box3d box_;
  double wavelength_;
  std::uint64_t seed_;
};

class Level final : public Function {
 public:
  explicit Level(float v) : value_(v) {}
  void values(std::span<const Vec3d>, std::span<float> out) const override {
    std::fill(out.begin(), out.end(), value_);
  }
  Interval range(const Box3d&) const override { return {value_, value_}; }

 private:
  float value_;
};

FunctionPtr patch(std::uint64_t seed) {
  return std::make_shared<Patchy>(Box3d{{-50, -40, -30}, {45, 55, 25}}, 17, seed);
}
FunctionPtr rock(std::uint64_t seed) {
  return std::make_shared<Patchy>(Box3d::everything(), 6, seed);
}
FunctionPtr level(float v) {
  return std::make_shared<Level>(v);
}

NodePtr spots(int count, double extent, std::uint64_t seed, double energy = -7) {
  CloudBuilder cloud({"point", 15, {}});
  Random random(seed);
  for (int i = 0; i < count; ++i)
    add_point(cloud,
              {random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-15, 15)},
              random.uniform(2, 7), random.uniform(-std::fabs(energy), energy + 9));
  return cloud.finish();
}

NodePtr land(int count = 200, std::uint64_t seed = 1) {
  return blend({terrain(), spots(count, 70, seed)});
}

const WarpSettings folds{{3, 2, 1.5}, 19, 11, 3, 5};

/// A column of balls and a segment, about 14 m high.
NodePtr hoodoo() {
  CloudBuilder balls({"sphere", 3, {}}), stem({"segment", 15, {0.4, 2, 2, 3}});
  Random random(3);
  for (int i = 0; i < 8; ++i) {
    const float radius = draw_float(random, 0.5, 1.5);
    balls.add({random.uniform(-1, 1), random.uniform(-1, 1), i * 1.5}, 6, std::vector<float>{radius});
  }
  add_segment(stem, {0, 0, -2}, {0.5, 0, 13}, 3, 5);
  return blend({balls.finish(), stem.finish()});
}

std::vector<Placement> places(int count, std::uint64_t seed, double extent = 80) {
  Random random(seed);
  std::vector<Placement> out;
  for (int i = 0; i < count; ++i)
    out.push_back({{random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-9, 5)},
                   random.uniform(-4, 4),
                   i % 3 ? 0 : random.uniform(-1, 1),
                   random.uniform(0.5, 1.6)});
  return out;
}

struct Case {
  std::string name;
  NodePtr tree;
};

/// Every operator over the same land, alone and nested in each other.
std::vector<Case> cases() {
  std::vector<Case> out;
  const auto add = [&](std::string name, NodePtr tree) { out.push_back({std::move(name), std::move(tree)}); };
  const NodePtr ground = land();
  const NodePtr ball = blend({constant(-7.5f), spots(12, 20, 9, 12)});
  const NodePtr eroded = erode(ground, patch(1), rock(2), 4);
  const NodePtr warped = warp(ground, patch(3), folds);
  add("erode", eroded);
  add("erode_everywhere", erode(ground, nullptr, rock(2), 3));
  add("warp", warped);
  add("warp_everywhere", warp(ground, nullptr, folds));
  add("warp_of_a_warp", warp(warp(ground, patch(4), folds), nullptr, {{1, 1, 1}, 7, 9, 2, 8}));
  add("erode_a_warp", erode(warped, patch(5), rock(6), 4));
  add("warp_an_erosion", warp(eroded, patch(7), folds));
  add("union_of_warps", unite({warped, warp(ball, nullptr, folds)}));
  add("transform", transform(ground, {{5, -7, 2}, 0.7, 0, 1.2}));
  add("transform_tilted", unite({ground, transform(ball, {{10, 6, 4}, 0.7, 0.9, 0.8})}));
  add("transform_a_warp", transform(warped, {{3, 4, 1}, -2, 0.05, 0.9}));
  add("round", round_edge(ground, transform(eroded, {{9, 0, 0}, 1, 0, 1}), 1.5));
  add("morph", morph(ground, transform(eroded, {{9, 0, 0}, 1, 0, 1}), 0.3));
  add("instances", blend({ground, instances(hoodoo(), places(300, 1))}));
  add("instances_alone",
      unite({constant(-7.5f), blend({constant(-7.5f), instances(hoodoo(), places(40, 4))})}));
  add("warp_instances", warp(blend({ground, instances(hoodoo(), places(60, 2))}), nullptr, folds));
  add("instances_of_instances",
      blend({ground, instances(instances(warp(hoodoo(), nullptr, folds), places(5, 3, 12)), places(20, 5))}));
  add("controls_of_primitives", erode(warp(ground, as_function(spots(30, 50, 3, 3)), folds),
                                      as_function(spots(30, 50, 4, 3)), rock(1), 4));
  return out;
}

class Trees : public testing::TestWithParam<Case> {};

TEST_P(Trees, PruneExactly) {
  const CompiledField field = compile(GetParam().tree);
  EXPECT_GT(Lattice(field, 0.83).check(-1, -1, 0, 0), 10000u);
}

TEST_P(Trees, RangesEncloseValues) {
  const CompiledField field = compile(GetParam().tree);
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Vec3d c{random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-60, 30)};
    const Box3d box = Box3d{c, c}.grown(random.uniform(0.1, 15));
    const Interval range = field.interval(box);
    for (int k = 0; k < 40; ++k) {
      const float v = field.value({random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                                   random.uniform(box.lo.z, box.hi.z)});
      EXPECT_GE(v, range.lo);
      EXPECT_LE(v, range.hi);
    }
  }
}

TEST_P(Trees, GradientsMatchDifferences) {
  const CompiledField field = compile(GetParam().tree);
  Random random(5);
  std::vector<Vec3d> points;
  for (int i = 0; i < 300; ++i)
    points.push_back({random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-12, 12)});
  std::vector<float> values(points.size());
  std::vector<Vec3f> gradients(points.size());
  field.gradients(points, values, gradients);
  int rough = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(values[i], field.value(points[i]));
    const double h = 0.01;
    const Vec3d p = points[i];
    const auto slope = [&](Vec3d d) { return (field.value(p + d * h) - field.value(p - d * h)) / (2 * h); };
    const Vec3d d{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
    rough += length(d - to_double(gradients[i])) > 0.02 * (1 + length(d));
  }
  EXPECT_LE(rough, 12) << "more than kinks can explain";
}

TEST_P(Trees, ManyPointsEqualOneByOneAtAnyThreadCount) {
  const CompiledField field = compile(GetParam().tree);
  Random random(8);
  std::vector<Vec3d> points;
  for (int i = 0; i < 5000; ++i)
    points.push_back({random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-15, 15)});
  std::vector<float> one(points.size()), two(points.size());
  set_thread_count(1);
  field.values(points, one);
  set_thread_count(2);
  field.values(points, two);
  set_thread_count(0);
  EXPECT_EQ(one, two);
  for (std::size_t i = 0; i < 300; ++i) EXPECT_EQ(field.value(points[i]), one[i]);
}

TEST_P(Trees, BoundsHoldTheSurface) {
  const CompiledField field = compile(GetParam().tree);
  const Box3d bounds = field.bounds();
  Random random(2);
  for (int i = 0; i < 3000; ++i) {
    const Vec3d p{random.uniform(-95, 95), random.uniform(-95, 95), random.uniform(-100, 100)};
    if (p.z > bounds.hi.z) {
      EXPECT_LT(field.value(p), 0);
    }
  }
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
  return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Operators, Trees, testing::ValuesIn(cases()), case_name);

std::vector<Vec3d> some_points(int count, double extent, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> points;
  for (int i = 0; i < count; ++i)
    points.push_back(
        {random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-20, 20)});
  return points;
}

TEST(Erode, TakesDepthTimesControlTimesSoftnessOff) {
  const CompiledField bare = compile(land()), eroded = compile(erode(land(), level(0.5f), level(0.25f), 4));
  const CompiledField half = compile(erode(land(), nullptr, nullptr, 3));
  for (const Vec3d& p : some_points(500, 90, 1)) {
    EXPECT_NEAR(eroded.value(p), bare.value(p) - 1.5, 1e-5);
    EXPECT_EQ(half.value(p), eroded.value(p));
  }
}

TEST(Erode, LeavesHardRockAndWhatIsOutOfReachBitForBit) {
  const CompiledField bare = compile(land()), hard = compile(erode(land(), nullptr, level(1), 4)),
                      eroded = compile(erode(land(), patch(1), rock(2), 4));
  for (const Vec3d& p : some_points(2000, 95, 2)) {
    EXPECT_EQ(hard.value(p), bare.value(p));
    if (p.x > 45 || p.y < -40) {
      EXPECT_EQ(eroded.value(p), bare.value(p));
    }
  }
}

TEST(Erode, DeepRockStaysSolidAndIsPruned) {
  const CompiledField eroded = compile(erode(terrain(15, 7.5, true, true, false), nullptr, level(0), 5));
  EXPECT_GT(eroded.interval({{-20, -20, -90}, {20, 20, -70}}).lo, 0);
  EXPECT_GT(eroded.value({0, 0, -45}), 0);
}

TEST(Warp, OfNoAmplitudeAndOfNoControlChangesNothing) {
  const CompiledField bare = compile(land()), still = compile(warp(land(), level(0), folds)),
                      partly = compile(warp(land(), patch(3), folds));
  EXPECT_EQ(warp(land(), nullptr, {{0, 0, 0}, 20, 20, 3, 1})->depth, 0);
  int moved = 0;
  for (const Vec3d& p : some_points(2000, 95, 3)) {
    EXPECT_EQ(still.value(p), bare.value(p));
    if (p.x > 45 || p.y < -40) {
      EXPECT_EQ(partly.value(p), bare.value(p));
    } else {
      moved += partly.value(p) != bare.value(p);
    }
  }
  EXPECT_GT(moved, 200);
}

TEST(Warp, MovesTheSurfaceByUpToItsAmplitudeAndFarFromTheOriginToo) {
  auto flat = std::make_shared<raster::Raster>();
  flat->values = raster::Grid<float>(8, 8, 0.f);
  flat->placement = {100000, 100040, 5, 5};
  const NodePtr plain = heightfield(flat, HeightfieldSettings{15, 7.5, true, false});
  const CompiledField field = compile(warp(plain, nullptr, {{0, 0, 3}, 25, 25, 2, 4}));
  double least = 9, most = -9, before = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p{100000 + i * 0.02, 100020, 0};
    const double z = field.value(p);  // sigma(x) is close to x: -(0 + delta)
    least = std::min(least, z), most = std::max(most, z);
    if (i > 0) {
      EXPECT_LT(std::fabs(z - before), 0.05) << "jitter at " << p.x;
    }
    before = z;
  }
  EXPECT_GT(most - least, 0.5);
  EXPECT_LT(std::max(most, -least), 3.2);
}

TEST(Warp, DeepChainsWorkAndBottomlessOnesAreRefused) {
  NodePtr node = land(30);
  for (std::uint64_t i = 0; i < 40; ++i) node = warp(node, nullptr, {{0.1, 0.1, 0.1}, 20, 20, 1, i});
  const CompiledField field = compile(node), bare = compile(land(30));
  double sum = 0;
  for (const Vec3d& p : some_points(50, 60, 4)) sum += std::fabs(field.value(p) - bare.value(p));
  EXPECT_LT(sum / 50, 2);
  EXPECT_THAT(error_of([&] {
                for (int i = 0; i < 40; ++i) node = warp(node, nullptr, folds);
              }),
              HasSubstr("deep in one another; remove some"));
}

TEST(Transform, AgreesWithTheTreeAtItsOwnPositions) {
  const Placement at{{5, -7, 2}, 0.7, 0.4, 1.6};
  const CompiledField bare = compile(land()), placed = compile(transform(land(), at));
  const auto rotate = [](Vec3d p, double turn, double tilt) {
    const Vec3d q{std::cos(tilt) * p.x + std::sin(tilt) * p.z, p.y,
                  -std::sin(tilt) * p.x + std::cos(tilt) * p.z};
    return Vec3d{std::cos(turn) * q.x - std::sin(turn) * q.y, std::sin(turn) * q.x + std::cos(turn) * q.y,
                 q.z};
  };
  for (const Vec3d& own : some_points(500, 60, 5)) {
    const Vec3d p = at.position + rotate(own, at.turn, at.tilt) * at.scale;
    EXPECT_NEAR(placed.value(p), at.scale * bare.value(own), 1e-4);
  }
  EXPECT_EQ(error_of([&] {
              transform(land(), {{0, 0, 0}, 0, 0, 0});
            }),
            "a placement's scale is 0; it must be positive");
}

TEST(Instances, AreTheBlendOfTransforms) {
  const auto at = places(40, 1, 25);
  std::vector<NodePtr> copies;
  for (const Placement& p : at) copies.push_back(transform(hoodoo(), p));
  const CompiledField all = compile(instances(hoodoo(), at)), one_by_one = compile(blend(copies));
  int inside = 0;
  for (const Vec3d& p : some_points(3000, 35, 5)) {
    const float v = all.value(p);
    EXPECT_NEAR(v, one_by_one.value(p), 2e-3f);  // positions are quantized to 0.1 mm
    inside += v != 0;
  }
  EXPECT_GT(inside, 500);
}

TEST(Instances, DoNotDependOnTheOrderGiven) {
  auto at = places(200, 1, 25);
  const CompiledField forwards = compile(instances(hoodoo(), at));
  std::reverse(at.begin(), at.end());
  const CompiledField backwards = compile(instances(hoodoo(), at));
  for (const Vec3d& p : some_points(1000, 30, 5)) EXPECT_EQ(forwards.value(p), backwards.value(p));
}

TEST(Instances, AreSmallAndCounted) {
  const NodePtr shape = hoodoo();
  const TreeStats one = stats(instances(shape, places(1, 1))),
                  many = stats(instances(shape, places(10001, 1)));
  EXPECT_EQ(many.nodes - one.nodes, 10000u);
  EXPECT_EQ(many.primitives, one.primitives);
  EXPECT_LE(many.bytes - one.bytes, 320'000u);
}

TEST(Instances, RefuseWhatHasNoEnd) {
  EXPECT_THAT(error_of([&] { instances(land(), places(3, 1)); }),
              HasSubstr("only a tree that is 0 outside of a box can be instanced"));
  const std::vector<Placement> far{{{2e5, 0, 0}, 0, 0, 1}};
  EXPECT_THAT(error_of([&] { instances(hoodoo(), far); }),
              HasSubstr("from the scene's origin; the limit is"));
  EXPECT_EQ(compile(instances(hoodoo(), {})).value({0, 0, 0}), 0.f);
}

TEST(Support, IsExactlyWhereATreeVanishes) {
  const NodePtr cloud = spots(20, 10, 1);
  EXPECT_FALSE(support(land()).bounded());
  EXPECT_TRUE(support(constant(0)).empty());
  EXPECT_FALSE(support(constant(1)).bounded());
  for (const NodePtr& tree :
       {cloud, warp(cloud, nullptr, folds), transform(cloud, {{40, 3, 1}, 1, 0.6, 2}),
        instances(hoodoo(), places(9, 7, 40)), unite({cloud, transform(cloud, {{9, 9, 9}, 0, 0, 1})}),
        function(patch(1)), erode(cloud, patch(1), rock(1), 2), morph(cloud, function(patch(2)), 0.4)}) {
    const Box3d box = support(tree);
    ASSERT_TRUE(box.bounded());
    const CompiledField field = compile(tree);
    int inside = 0;
    for (const Vec3d& p : some_points(4000, 110, 7)) {
      if (box.contains(p))
        inside += field.value(p) != 0;
      else
        EXPECT_EQ(field.value(p), 0.f);
    }
    EXPECT_GT(inside, 5);
  }
}

}  // namespace
}  // namespace tafoni::field
