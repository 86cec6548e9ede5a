// What every solid must keep to, asked of each in the registry.

#include "tafoni/grammar/solid.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/effects.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/function.h"
#include "tafoni/grammar/leaf.h"

namespace tafoni::grammar {
namespace {

using testing::HasSubstr;

Vec3d place(Random& random, const Box3d& box) {
  return {random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
          random.uniform(box.lo.z, box.hi.z)};
}

class EverySolid : public testing::TestWithParam<const SolidType*> {
 protected:
  static constexpr Vec3d half{3, 2, 1.5};
  SolidPtr solid() const { return GetParam()->make(GetParam()->fit(half)); }
  bool empty() const { return solid()->bounds().empty(); }

  static Vec3d unit(Random& random) { return normalized(place(random, {{-1, -1, -1}, {1, 1, 1}})); }
  /// By differences; `h` metres apart.
  static Vec3d gradient(const Solid& solid, Vec3d p, double h = 1e-5) {
    const auto along = [&](Vec3d d) {
      return (solid.distance(p + d * h) - solid.distance(p - d * h)) / (2 * h);
    };
    return {along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
  }
};

TEST_P(EverySolid, IsDocumented) {
  const SolidType& type = *GetParam();
  EXPECT_FALSE(type.about.doc.empty());
  EXPECT_FALSE(type.about.source.empty());
  EXPECT_EQ(&find_solid(type.about.name), &type);
  for (const ParamInfo& info : type.about.params) {
    EXPECT_FALSE(info.doc.empty()) << info.name;
    EXPECT_EQ(info.unit, "m") << info.name;
    EXPECT_NO_THROW(check_value(info, info.init, type.about.name)) << info.name;
    EXPECT_THAT(error_of([&] {
                  type.make({{info.name, -1.0}});
                }),
                HasSubstr(type.about.name + ": " + info.name + " = -1 is outside "));
  }
  EXPECT_THAT(error_of([&] {
                type.make({{"colour", 1.0}});
              }),
              HasSubstr(type.about.name + ": unknown parameter \"colour\""));
}

TEST_P(EverySolid, EverySizeDoesSomething) {
  Random random(7);
  std::vector<Vec3d> points(100);
  for (Vec3d& p : points) p = place(random, {{-6, -6, -6}, {6, 6, 6}});
  const auto make = [&](const Values& sizes) {
    const SolidPtr s = GetParam()->make(sizes);
    std::vector<double> distances;
    for (const Vec3d& p : points) distances.push_back(s->distance(p));
    return std::optional(distances);
  };
  for (const ParamInfo& info : GetParam()->about.params) EXPECT_TRUE(has_effect(info, {}, make)) << info.name;
}

TEST_P(EverySolid, ChangesNoFasterThanTheWay) {
  for (const Vec3d size : {half, Vec3d{5, 0.5, 0.5}, Vec3d{5, 4, 0.05}, Vec3d{0.05, 0.05, 5}}) {
    const SolidPtr s = GetParam()->make(GetParam()->fit(size));
    Random random(1);
    for (int i = 0; i < 3000; ++i) {
      Vec3d p = place(random, {{-6, -6, -6}, {6, 6, 6}});
      // Lattices put many samples right between two sides.
      if (i % 3 == 0) (i % 2 ? p.z : p.y) = 0;
      if (i % 9 == 0) p.x = 0;
      const Vec3d way = unit(random);
      const Vec3d q = p + way * random.uniform(0, i % 2 ? 0.1 : 4);
      ASSERT_LE(std::abs(s->distance(p) - s->distance(q)), length(p - q) + 1e-7)
          << size.x << ' ' << size.z << " at " << p.x << ' ' << p.y << ' ' << p.z;
    }
  }
}

// With the test above: so the value is the distance.
TEST_P(EverySolid, TheSurfaceLiesAsFarAsItSays) {
  if (empty()) return;
  const SolidPtr s = solid();
  Random random(2);
  int met = 0, asked = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p = place(random, {{-5, -5, -5}, {5, 5, 5}});
    const double d = s->distance(p);
    const Vec3d g = gradient(*s, p);
    ++asked;
    // Where two places of the surface are as near, differences say nothing.
    if (std::abs(length(g) - 1) > 1e-4) continue;
    ++met;
    ASSERT_NEAR(s->distance(p - g * d), 0, 1e-3) << p.x << ' ' << p.y << ' ' << p.z;
  }
  EXPECT_GT(met, 0.98 * asked);
}

TEST_P(EverySolid, BondsLieOnTheSurfaceAndLookOut) {
  if (empty()) {
    EXPECT_TRUE(solid()->bonds().empty());
    return;
  }
  const SolidPtr s = solid();
  EXPECT_GE(s->bonds().size(), 6u);
  for (const Bond& bond : s->bonds()) {
    EXPECT_NEAR(s->distance(bond.point), 0, 1e-8);
    if (bond.direction == Vec3d{}) continue;
    EXPECT_NEAR(length(bond.direction), 1, 1e-12);
    EXPECT_NEAR(s->distance(bond.point + bond.direction * 0.05), -0.05, 1e-8);
    EXPECT_NEAR(s->distance(bond.point - bond.direction * 0.05), 0.05, 1e-8);
  }
}

TEST_P(EverySolid, FillsTheBoxItWasFittedTo) {
  if (empty()) return;
  const SolidPtr s = solid();
  const Box3d box = s->bounds();
  EXPECT_LE(box.hi.x, half.x);
  EXPECT_LE(box.hi.y, half.y);
  EXPECT_LE(box.hi.z, half.z);
  EXPECT_NEAR(std::min({box.hi.x, box.hi.y, box.hi.z}), half.z, half.z / 2);
  Box3d seen;
  Random random(3);
  for (int i = 0; i < 200000; ++i) {
    const Vec3d p = place(random, box.grown(0.5));
    if (s->distance(p) <= 0) continue;
    ASSERT_TRUE(box.contains(p));
    seen.expand(p);
  }
  EXPECT_LT(length(box.lo - seen.lo), 0.5);
  EXPECT_LT(length(box.hi - seen.hi), 0.5);
}

TEST_P(EverySolid, TheRangeOverABoxHoldsItsValues) {
  Random random(4);
  for (int i = 0; i < 400; ++i) {
    const Vec3d axis = unit(random);
    Pose pose = turn(axis, random.uniform(-3, 3));
    pose.at = place(random, {{-2, -2, -2}, {2, 2, 2}});
    const field::FunctionPtr f = as_function(solid(), pose);
    const Vec3d corner = place(random, {{-5, -5, -5}, {5, 5, 5}});
    const double size = random.uniform(0, 3);
    const Box3d box{corner, corner + Vec3d{size, size * random.uniform(), size * random.uniform()}};
    const Interval range = f->range(box);
    EXPECT_LE(range.hi - range.lo, 1.001f * static_cast<float>(length(box.size())) + (empty() ? 3.f : 1e-3f));
    for (int k = 0; k < 50; ++k) {
      const Vec3d p = place(random, box);
      float value = 0;
      f->values({&p, 1}, {&value, 1});
      ASSERT_TRUE(range.contains(value));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, EverySolid, testing::ValuesIn(all_solids().begin(), all_solids().end()),
                         [](const auto& test_case) { return test_case.param->about.name; });

TEST(Torus, WhoseTubeFillsItsHoleHasNoInnerSurface) {
  const SolidPtr s = find_solid("torus").make({{"ring", 1.0}, {"tube", 2.0}});
  // The outer surface ends in a dent on the axis.
  const double dent = std::sqrt(3.0);
  EXPECT_NEAR(s->distance({0, 0, 0}), dent, 1e-12);
  EXPECT_NEAR(s->distance({0, 0, dent}), 0, 1e-12);
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = place(random, {{-2, -2, -2}, {2, 2, 2}});
    double nearest = 1e9;
    const double r = std::hypot(p.x, p.y);
    for (int k = 0; k < 20000; ++k) {
      const double a = 6.283185307179586 * k / 20000, x = 1 + 2 * std::cos(a), z = 2 * std::sin(a);
      if (x >= 0) nearest = std::min(nearest, std::hypot(x - r, z - p.z));
    }
    ASSERT_NEAR(std::abs(s->distance(p)), nearest, 2e-3);
    ASSERT_EQ(s->distance(p) > 0, std::hypot(r - 1, p.z) < 2);
  }
}

TEST(Solid, AnUnknownNameGetsTheNearestKnown) {
  try {
    find_solid("pyramidd");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), testing::StrEq("there is no solid \"pyramidd\"; did you mean \"pyramid\"?"));
  }
}

TEST(Pose, TurnsBringOneDirectionToAnother) {
  Random random(5);
  const auto unit = [&] {
    return normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  };
  for (int i = 0; i < 300; ++i) {
    const Vec3d a = unit(), b = i % 3 == 0 ? -a : unit();
    const Pose pose = turn(a, b);
    EXPECT_LT(length(pose.turned(a) - b), 1e-9);
    EXPECT_NEAR(dot(cross(pose.x, pose.y), pose.z), 1, 1e-9);
    Pose moved = pose;
    moved.at = unit();
    const Vec3d p = unit();
    EXPECT_LT(length(moved.own(moved.placed(p)) - p), 1e-12);
    EXPECT_LT(length(moved.placed(pose).placed(p) - moved.placed(pose.placed(p))), 1e-12);
  }
}

}  // namespace
}  // namespace tafoni::grammar
