#include <gtest/gtest.h>

#include "tafoni/landforms/test/site.h"
#include "tafoni/math/counts.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

Result sea(const Site& site, Values values = {}) {
  values.emplace("weathering", 0.0);
  values.emplace("cave_spacing", 0.0);
  return find_landform("sea-cliff").generate(site, values, silent());
}

/// Share of the places in `box` that were rock and are air now.
double carved_share(const Site& site, const Result& result, const Box3d& box) {
  const auto points = test::places(box, 40000, 8);
  const auto before = test::values(field::compile(site.terrain), points);
  const auto after = test::values(test::carved(site, result), points);
  int gone = 0;
  for (std::size_t i = 0; i < points.size(); ++i) gone += before[i] > 0 && after[i] <= 0;
  return ratio(gone, points.size());
}

constexpr Box3d face{{-40, -8, -8}, {40, 15, 30}};

TEST(SeaCliff, UndercutsOnlyInTheRangeOfTheSea) {
  const Coast coast;
  const Result result = sea(coast.site);
  const auto field = test::carved(coast.site, result);
  int roofed = 0;
  for (const Vec3d p : test::places(face, 60000, 1)) {
    const bool air = field.value(p) <= 0;
    bool under = false;
    for (double up = 1; up < 25 && air && !under; up += 0.7) under = field.value(p + Vec3d{0, 0, up}) > 0;
    roofed += under;
    // A primitive at the edge of the range still reaches its radius of 1.3 x 5 m.
    if (under) {
      ASSERT_LT(p.z, 8 + 6.5);
    }
  }
  EXPECT_GT(roofed, 1500) << "no overhang to speak of";
  EXPECT_EQ(carved_share(coast.site, result, {{-40, -8, 15}, {40, 15, 30}}), 0);
}

TEST(SeaCliff, SoftRockAndMoreStepsLoseMore) {
  double last = 1;
  for (double rho : {0.0, 0.4, 0.8}) {
    const Coast coast([rho](Vec3d) { return rho; });
    const double lost = carved_share(coast.site, sea(coast.site, {{"joints", 0.0}}), face);
    EXPECT_LT(lost, last);
    EXPECT_GT(lost, 0);
    last = lost;
  }
  const Coast coast;
  double least = 0;
  for (std::int64_t steps : {1, 2, 4}) {
    const double lost = carved_share(coast.site, sea(coast.site, {{"steps", steps}}), face);
    EXPECT_GT(lost, least);
    least = lost;
  }
}

/// What one step takes off the field in `box`, summed: proportional to the primitives' energies there.
double energy_in(const Coast& coast, const Box3d& box, Values values) {
  for (const auto& [name, value] : Values{{"steps", std::int64_t{1}},
                                          {"joints", 0.0},
                                          {"roughness", 0.0},
                                          {"accessibility", 0.0},
                                          {"threshold", 0.0}})
    values.emplace(name, value);
  const Result result = sea(coast.site, values);
  const auto points = test::places(box, 60000, 9);
  const auto before = test::values(field::compile(coast.site.terrain), points);
  const auto after = test::values(test::carved(coast.site, result), points);
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += before[i] - after[i];
  return sum;
}

// e(rho, sigma) = sigma ((1 - rho)(1 - beta) + beta), [Paris19 §6.1].
TEST(SeaCliff, EnergyFollowsResistance) {
  const auto energy = [](double rho) {
    return energy_in(Coast([rho](Vec3d) { return rho; }), face, {{"beta", 0.3}});
  };
  const double soft = energy(0);
  EXPECT_NEAR(energy(0.5) / soft, 0.65, 0.07);
  EXPECT_NEAR(energy(1) / soft, 0.3, 0.07);
}

TEST(SeaCliff, EnergyFollowsStress) {
  // The face is steep from -3 to 30 m; w = 1 - u^2 is 1 at the sea level, 0.36 at 0.8 of the range.
  const auto energy = [](double z) {
    return energy_in(Coast(), {{-40, -8, z - 1.5}, {40, 15, z + 1.5}},
                     {{"sea_level", 10.0}, {"range", 16.0}, {"radius", 2.0}, {"spacing", 1.0}});
  };
  const double most = energy(10);
  EXPECT_GT(most, 0);
  EXPECT_NEAR(energy(10 + 0.5 * 16) / most, 0.75, 0.15);
  EXPECT_NEAR(energy(10 + 0.8 * 16) / most, 0.36, 0.12);
}

TEST(SeaCliff, FollowsTheBeds) {
  const Coast coast([](Vec3d p) { return p.z > 2 ? 0.95 : 0.05; });
  const Result result = sea(coast.site, {{"joints", 0.0}});
  const double soft = carved_share(coast.site, result, {{-40, -8, -2}, {40, 15, 1}});
  const double hard = carved_share(coast.site, result, {{-40, -8, 4}, {40, 15, 7}});
  EXPECT_GT(soft, 1.5 * hard);
}

TEST(SeaCliff, KeepsBeachAndPlatform) {
  const Coast beach([](Vec3d) { return 0.0; }, [](double, double y) { return 0.08 * y; });
  EXPECT_TRUE(sea(beach.site).nodes.empty());
  const Coast coast([](Vec3d) { return 0.0; });
  const double lowered =
      carved_share(coast.site, sea(coast.site), {{-40, -12, -12}, {40, 15, Coast::shelf - 1.5}});
  EXPECT_LT(lowered, 0.002);
}

TEST(SeaCliff, InlandFacesFeelNoSea) {
  // A step inside the range, 60 m from the water.
  const Coast coast([](Vec3d) { return 0.0; },
                    [](double, double y) { return y < -40 ? -3.0 : std::clamp(2 + 3 * (y - 20), 2.0, 7.0); });
  EXPECT_EQ(carved_share(coast.site, sea(coast.site), {{-50, 10, -5}, {50, 40, 10}}), 0);
}

TEST(SeaCliff, CutsNoStackOff) {
  // A pillar 14 m across in the softest rock, attacked from all sides by many steps.
  const Coast coast([](Vec3d) { return 0.0; },
                    [](double x, double y) { return std::hypot(x, y) < 7 ? 30.0 : -3.0; });
  const auto field = test::carved(coast.site, sea(coast.site, {{"steps", std::int64_t{6}}}));
  for (double z = -4; z < 25; z += 0.5) EXPECT_GT(field.value({0, 0, z}), 0) << z;
}

TEST(SeaCliff, CavesRunIntoTheRockAndPierceHeadlands) {
  const Coast coast([](Vec3d p) { return std::abs(p.x) < 4 ? 0.05 : 0.6; });
  const Result result = find_landform("sea-cliff").generate(coast.site, {{"cave_spacing", 15.0}}, silent());
  EXPECT_GT(test::fact<std::int64_t>(result, "caves"), 0);
  const Coast wall([](Vec3d) { return 0.2; }, [](double, double y) { return std::abs(y) < 6 ? 30.0 : -3.0; });
  const Result arches = find_landform("sea-cliff").generate(wall.site, {{"cave_spacing", 20.0}}, silent());
  EXPECT_GT(test::fact<std::int64_t>(arches, "arches"), 0);
}

TEST(SeaCliff, NoStressWhereTheSeaIsFarBelow) {
  const Coast coast;
  EXPECT_TRUE(sea(coast.site, {{"sea_level", -200.0}}).nodes.empty());
}

}  // namespace
}  // namespace tafoni::landforms
