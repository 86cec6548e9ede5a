#include <gtest/gtest.h>

#include "tafoni/landforms/spires/towers.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

Result spires(const Site& site, Values values = {}) {
  return find_landform("spires").generate(site, values, silent());
}

double level_ground(double, double) {
  return 0;
}

TEST(Spires, StandOnTheGroundAndAreTallAndSlender) {
  Coast coast([](Vec3d) { return 0.6; }, level_ground);
  const Result result =
      spires(coast.site, {{"count", std::int64_t{5}}, {"height", 60.0}, {"slenderness", 6.0}});
  const auto field = test::carved(coast.site, result);
  const auto feet = test::fact<Places>(result, "positions").local;
  const auto heights = test::fact<std::vector<double>>(result, "heights");
  ASSERT_GE(heights.size(), 3u);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const Vec3d foot = feet[i];
    for (double t : {-0.05, 0.05, 0.3, 0.6, 0.85})
      EXPECT_GT(field.value(foot + Vec3d{0, 0, t * heights[i]}), 0) << "rock without a gap, height " << t;
    EXPECT_LT(field.value(foot + Vec3d{0, 0, 1.25 * heights[i]}), 0);
  }
}

TEST(Spires, HardBedsStandOut) {
  const auto beds = [](Vec3d p) { return std::fmod(p.z + 600, 8) < 4 ? 0.0 : 1.0; };
  Coast coast(beds, level_ground);
  const Result result =
      spires(coast.site, {{"count", std::int64_t{6}}, {"height", 60.0}, {"strata", 1.0}, {"roughness", 0.0}});
  const auto field = test::carved(coast.site, result);
  int soft = 0, hard = 0;
  for (const Vec3d p : test::places({{-60, -45, 8}, {60, 45, 32}}, 150000, 3))
    if (field.value(p) > 0) ++(beds(p) > 0.5 ? hard : soft);
  ASSERT_GT(soft, 500);
  EXPECT_GT(hard, 1.1 * soft);
}

TEST(Towers, RangesEncloseValues) {
  std::vector<impl::Tower> towers;
  Random random(7);
  for (int i = 0; i < 12; ++i) {
    impl::Tower tower;
    tower.foot = {random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-3, 3)};
    tower.height = random.uniform(15, 40);
    for (int k = 0; k < 3; ++k) {
      impl::Block b;
      b.at = {tower.foot.x + random.uniform(-4, 4), tower.foot.y + random.uniform(-4, 4)};
      b.half = {random.uniform(1, 5), random.uniform(1, 5)};
      b.cut = 0.3;
      b.turn = random.uniform(0, 3);
      b.top = tower.height * random.uniform(0.5, 1);
      b.lean = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
      b.tilt = {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4)};
      b.widths = {1, 0.95, 0.9, 0.8, 0.75, 0.6};
      tower.blocks.push_back(b);
    }
    towers.push_back(tower);
  }
  impl::RockTexture texture;
  texture.unevenness = 1;
  texture.relief = 1;
  const impl::Towers forest(towers, texture);
  for (int i = 0; i < 4000; ++i) {
    const double size = std::exp(random.uniform(-1, 3.5));
    const Vec3d lo{random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(-30, 60)};
    const Box3d box{lo, lo + Vec3d{size, random.uniform(0.2, 1) * size, random.uniform(0.2, 1) * size}};
    const Interval range = forest.range(box);
    const auto points = test::places(box, 12, i);
    std::vector<float> values(points.size());
    forest.values(points, values);
    for (float v : values) ASSERT_TRUE(range.contains(v)) << range.lo << " " << v << " " << range.hi;
  }
}

}  // namespace
}  // namespace tafoni::landforms
