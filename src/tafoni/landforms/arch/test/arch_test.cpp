#include <gtest/gtest.h>

#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

Result arch(const Site& site, Values values = {}) {
  return find_landform("arch").generate(site, values, silent());
}

/// A wall along y = 0, ten metres thick and thirty high, on level ground.
double fin(double, double y) {
  return 30 * std::clamp((5.5 - std::abs(y)) / 1.0, 0.0, 1.0);
}

/// Two plateaus with a valley of 40 m between them.
double valley(double x, double) {
  return 30 * std::clamp((std::abs(x) - 20) / 1.5, 0.0, 1.0);
}

bool open_along(const field::CompiledField& field, Vec3d from, Vec3d to) {
  for (int i = 0; i <= 200; ++i)
    if (field.value(from + (to - from) * (i / 200.0)) >= 0) return false;
  return true;
}

TEST(Arch, PiercesAFinAndLeavesTheRoofAndThePiers) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Coast coast([](Vec3d p) { return 0.4 + 0.2 * std::sin(p.x); }, fin);
    coast.site.seed = seed;
    const Result result = arch(coast.site, {{"count", std::int64_t{2}}, {"roof", 4.0}});
    ASSERT_GE(test::fact<std::int64_t>(result, "arches"), 1);
    const auto at = test::fact<Places>(result, "positions").local;
    const auto heights = test::fact<std::vector<double>>(result, "opening_heights");
    const auto before = field::compile(coast.site.terrain), after = test::carved(coast.site, result);
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const Vec3d c = at[i];
      EXPECT_GT(before.value({c.x, 0, c.z}), 0) << "there was rock";
      EXPECT_TRUE(open_along(after, {c.x, -12, c.z}, {c.x, 12, c.z}));
      // From the crown upwards at least the roof is left.
      double rock = 0;
      for (double z = c.z; z < 32; z += 0.1) rock += after.value({c.x, 0, z}) > 0 ? 0.1 : 0;
      EXPECT_GE(rock, 3.5);
      EXPECT_GT(after.value({c.x, 0, 28.5}), 0);
      for (double side : {-1.0, 1.0}) EXPECT_GT(after.value({c.x + side * 0.95 * heights[i], 0, c.z}), 0);
      EXPECT_NEAR(c.z - 0.5 * heights[i], 0, 2) << "stands on the ground";
    }
  }
}

TEST(Arch, TakesTheWeakestRockAndOpensItWider) {
  const auto run = [](double soft) {
    Coast coast([=](Vec3d p) { return p.x < 0 ? soft : 0.9; }, fin);
    const Result result = arch(coast.site, {{"count", std::int64_t{1}}, {"roughness", 0.0}});
    const auto at = test::fact<Places>(result, "positions").local;
    EXPECT_LT(at.at(0).x, 2);
    const auto before = field::compile(coast.site.terrain), after = test::carved(coast.site, result);
    int gone = 0;
    for (const Vec3d p : test::places({{-58, -6, 0}, {0, 6, 31}}, 60000, 1))
      gone += before.value(p) > 0 && after.value(p) <= 0;
    return gone;
  };
  EXPECT_GT(run(0.1), 1.2 * run(0.6));
}

TEST(Arch, OpensCliffsIntoAShaftBehindTheRim) {
  const Coast coast;
  const Result result = arch(coast.site);
  ASSERT_GE(test::fact<std::int64_t>(result, "arches"), 1);
  EXPECT_EQ(test::fact<std::int64_t>(arch(coast.site, {{"potholes", false}}), "arches"), 0)
      << "a straight cliff has no thin walls";
}

TEST(Arch, LeavesLevelGroundAlone) {
  const Coast coast([](Vec3d) { return 0.2; }, [](double, double) { return 10.0; });
  EXPECT_FALSE(arch(coast.site).reshape);
}

TEST(Arch, BridgesTwoGivenPoints) {
  Coast coast([](Vec3d) { return 0.5; }, valley);
  const Vec3d a{-22, 3, 27}, b{22, -4, 27};
  coast.site.points = {a, b};
  const Result result = arch(coast.site, {{"count", std::int64_t{0}}});
  ASSERT_EQ(test::fact<std::int64_t>(result, "bridges"), 1);
  const auto before = field::compile(coast.site.terrain), after = test::carved(coast.site, result);
  const auto at = test::fact<Places>(result, "positions").local;
  const Vec3d crown = at.at(0);
  EXPECT_LT(before.value(crown), 0);
  // Some rock over every place between the two, and a free way beneath the middle.
  for (double t = 0; t <= 1.0001; t += 0.05) {
    bool rock = false;
    for (double z = 22; z < 36 && !rock; z += 0.25)
      for (double s = -3; s <= 3 && !rock; s += 0.5)
        rock = after.value({a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t + s, z}) > 0;
    EXPECT_TRUE(rock) << t;
  }
  EXPECT_TRUE(open_along(after, {0, -10, 15}, {0, 10, 15}));
}

TEST(Arch, BridgesNarrowValleysByItself) {
  const Coast coast([](Vec3d) { return 0.5; }, valley);
  const Result result =
      arch(coast.site, {{"count", std::int64_t{0}}, {"bridges", std::int64_t{2}}, {"span", 60.0}});
  EXPECT_GE(test::fact<std::int64_t>(result, "bridges"), 1);
}

}  // namespace
}  // namespace tafoni::landforms
