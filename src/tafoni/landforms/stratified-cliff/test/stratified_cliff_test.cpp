#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

constexpr Box3d around{{-50, -35, -10}, {50, 35, 40}};

Result run(const Site& site, const Values& values = {}) {
  return find_landform("stratified-cliff").generate(site, values, silent());
}

bool soft(Vec3d p) {
  return std::fmod(p.z + 30, 6) < 2;
}
double bedded(Vec3d p) {
  return soft(p) ? 0.0 : 1.0;
}

/// How far into the cliff air reaches at a height, from where the face stands before.
double recess(const field::CompiledField& before, const field::CompiledField& after, double x, double z) {
  double face = -20, end = -20;
  while (face < 20 && before.value({x, face, z}) < 0) face += 0.05;
  while (end < 20 && after.value({x, end, z}) < 0) end += 0.05;
  return end - face;
}

TEST(StratifiedCliff, SoftBedsRecedeUnderHardOnes) {
  const Coast coast(&bedded);
  const auto before = field::compile(coast.site.terrain);
  const auto after = test::carved(coast.site, run(coast.site, {{"depth", 5.0}, {"detail", 0.0}}));
  double soft_mean = 0, hard_mean = 0;
  int soft_n = 0, hard_n = 0;
  for (double x = -40; x <= 40; x += 4)
    for (double z = 7; z < 24; z += 0.5) {
      const double in = recess(before, after, x, z);
      (soft({x, 0, z}) ? soft_mean : hard_mean) += in;
      ++(soft({x, 0, z}) ? soft_n : hard_n);
    }
  EXPECT_GT(soft_mean / soft_n, 0.8);
  EXPECT_NEAR(hard_mean / hard_n, 0, 0.1);
}

TEST(StratifiedCliff, LeavesTheGroundAboveAndBelowAsItIs) {
  const Coast coast([](Vec3d) { return 0.0; });
  const auto before = field::compile(coast.site.terrain);
  const auto after = test::carved(coast.site, run(coast.site, {{"depth", 4.0}}));
  for (double x = -45; x < 45; x += 1.7)
    for (const double y : {-30.0, -20.0, -10.0, 10.0, 20.0, 30.0}) {
      // The surface itself, within a small part of the depth.
      const double top = y > 0 ? Coast::plateau : Coast::shelf;
      for (double z = top - 1; z < top + 1; z += 0.1)
        ASSERT_NEAR(before.value({x, y, z}), after.value({x, y, z}), 0.05) << x << ' ' << y << ' ' << z;
    }
}

TEST(StratifiedCliff, RecedesByAtMostTheDepth) {
  const Coast coast([](Vec3d) { return 0.0; });
  const auto before = field::compile(coast.site.terrain);
  const auto after = test::carved(coast.site, run(coast.site, {{"depth", 4.0}, {"detail", 0.0}}));
  int changed = 0;
  for (const Vec3d p : test::places(around, 30000, 4)) {
    const float a = before.value(p), b = after.value(p);
    ASSERT_LE(b, a);
    ASSERT_GE(b, a - 4.001f);
    changed += a != b;
  }
  EXPECT_GT(changed, 300);
}

TEST(StratifiedCliff, WithoutAFaceThereIsNothing) {
  const Coast coast(&bedded, [](double x, double y) { return 10 + 0.3 * y + 0.1 * x; });
  const Result result = run(coast.site);
  EXPECT_FALSE(result.reshape);
  EXPECT_EQ(test::fact<double>(result, "face"), 0);
}

TEST(StratifiedCliff, ItsControlFieldPrunes) {
  const Coast coast(&bedded);
  const auto after = test::carved(coast.site, run(coast.site));
  const auto points = test::places(around, 2000, 9);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Box3d box = Box3d{points[i], points[i]}.grown(2);
    const Interval range = after.interval(box);
    for (const Vec3d p : test::places(box, 20, i)) ASSERT_TRUE(range.contains(after.value(p)));
  }
  const Interval inland = after.interval({{-5, 30, 15}, {5, 40, 20}});
  EXPECT_GT(inland.lo, 0) << "deep in the rock nothing can be air";
}

}  // namespace
}  // namespace tafoni::landforms
