#include <gtest/gtest.h>

#include "tafoni/landforms/test/flood.h"
#include "tafoni/landforms/test/site.h"
#include "tafoni/math/counts.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

Result islands(const Site& site, Values values = {}) {
  return find_landform("islands").generate(site, values, silent());
}

double flat(double, double) {
  return 0;
}

TEST(Islands, FloatClearOfTheGroundAndOfEachOther) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    Coast coast([](Vec3d) { return 0.7; }, flat);
    coast.site.seed = seed;
    const Result result = islands(coast.site, {{"count", std::int64_t{3}}, {"size", 26.0}, {"height", 50.0}});
    const auto n = test::fact<std::int64_t>(result, "islands");
    ASSERT_GE(n, 2);
    const auto field = test::carved(coast.site, result);
    const auto solid = test::pieces(field, {{-60, -45, -4}, {60, 45, 80}}, 1, true);
    std::int64_t large = 0;
    for (const test::Piece& piece : solid) large += piece.cells > 400;
    EXPECT_EQ(large, n + 1) << "the ground and each island";
  }
}

TEST(Islands, HangBetweenAGentleTopAndTaperingRoots) {
  Coast coast([](Vec3d) { return 0.9; }, flat);
  coast.site.points = {{0, 0, 45}};
  const Result result = islands(coast.site, {{"count", std::int64_t{0}}, {"size", 50.0}, {"variation", 0.0}});
  const auto field = test::carved(coast.site, result);
  EXPECT_GT(field.value({0, 0, 40}), 0);
  EXPECT_LT(field.value({0, 0, 60}), 0);
  EXPECT_LT(field.value({0, 0, 4}), 0);
  // Areas shrink downwards.
  const auto area = [&](double z) {
    int cells = 0;
    for (double y = -40; y <= 40; y += 1)
      for (double x = -40; x <= 40; x += 1) cells += field.value({x, y, z}) > 0;
    return cells;
  };
  const int high = area(42), middle = area(32), low = area(22);
  EXPECT_GT(high, 700);
  EXPECT_GT(high, middle);
  EXPECT_GT(middle, low);
}

TEST(Islands, SoftBedsRecede) {
  const auto beds = [](Vec3d p) { return std::fmod(p.z + 600, 6) < 3 ? 0.0 : 1.0; };
  const auto volume = [&](double strata) {
    Coast coast(beds, flat);
    coast.site.points = {{0, 0, 45}};
    const Result result =
        islands(coast.site, {{"count", std::int64_t{0}}, {"size", 50.0}, {"strata", strata}});
    const auto field = test::carved(coast.site, result);
    std::array<int, 2> cells{};
    for (const Vec3d p : test::places({{-35, -35, 20}, {35, 35, 42}}, 60000, 3))
      if (field.value(p) > 0) ++cells[beds(p) > 0.5];
    return ratio(cells[0], cells[1]);
  };
  EXPECT_LT(volume(5), 0.9 * volume(0.01));
}

TEST(Islands, CavesOpenOnThem) {
  Coast coast([](Vec3d) { return 0.2; }, flat);
  coast.site.points = {{0, 0, 60}};
  const Result made = islands(coast.site, {{"count", std::int64_t{0}}, {"size", 70.0}, {"variation", 0.0}});
  Site site = coast.site;
  site.points.clear();
  site.terrain = apply_to(coast.site.terrain, made);
  Region region;
  region.limit_altitude(15, 200);
  site.region = &region;
  const Result caves = find_landform("karst").generate(site, {{"radius", 1.5}}, silent());
  EXPECT_GT(test::fact<std::int64_t>(caves, "entrances"), 0);
  EXPECT_EQ(test::fact<std::int64_t>(caves, "networks"),
            test::fact<std::int64_t>(caves, "connected_networks"));
  for (const Vec3d p : test::fact<Places>(caves, "entrance_positions").local)
    EXPECT_GT(p.z + site.origin.z, 15);
}

}  // namespace
}  // namespace tafoni::landforms
