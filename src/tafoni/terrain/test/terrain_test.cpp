#include "tafoni/terrain/terrain.h"

#include <cmath>

#include <gmock/gmock.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/field/compiled.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/sampled.h"

namespace tafoni::terrain {
namespace {

using testing::HasSubstr;

raster::Raster hills(int width, int height, raster::Placement placement) {
  raster::Raster out = raster::sampled(width, height, placement, [](double x, double y) {
    return 300 + 20 * std::sin((x - 500'000) / 40) + 0.1 * (y - 5'900'000);
  });
  out.crs = "EPSG:32630";
  return out;
}
constexpr raster::Placement far_away{500'000, 5'900'200, 2, 2};

TEST(MakeTerrain, PutsTheOriginOnTheVoxelLatticeNearTheMiddle) {
  const raster::Raster world = hills(120, 100, far_away);
  for (const double voxel : {0.5, 0.3, 2.0}) {
    const Terrain t = make_terrain(world, voxel);
    for (const double v : {t.origin.x, t.origin.y, t.origin.z, t.box.lo.z, t.box.hi.z})
      EXPECT_NEAR(v / voxel, std::round(v / voxel), 1e-6);
    EXPECT_NEAR(t.origin.x, 500'120, voxel);
    EXPECT_NEAR(t.origin.y, 5'900'100, voxel);
    // World = origin + local, pixel by pixel.
    const Vec2d p = t.heights->placement.center(17, 33);
    const Vec2d w = far_away.center(17, 33);
    EXPECT_NEAR(p.x + t.origin.x, w.x, 1e-9);
    EXPECT_NEAR(p.y + t.origin.y, w.y, 1e-9);
    EXPECT_NEAR(t.heights->at(17, 33) + t.origin.z, world.at(17, 33), 2e-5);
  }
}

TEST(MakeTerrain, TheWholeRectangleReachesTheOuterBorderOfItsPixels) {
  const raster::Raster world = hills(120, 100, far_away);
  TerrainOptions options;
  options.depth = 40;
  const Terrain t = make_terrain(world, 0.5, options);
  EXPECT_EQ(t.inside, nullptr);
  EXPECT_EQ(t.valid, nullptr);
  EXPECT_DOUBLE_EQ(t.to_world(t.box.lo).x, 500'000);
  EXPECT_DOUBLE_EQ(t.to_world(t.box.hi).x, 500'240);
  EXPECT_DOUBLE_EQ(t.to_world(t.box.lo).y, 5'900'000);
  EXPECT_DOUBLE_EQ(t.to_world(t.box.hi).y, 5'900'200);
  double lowest = 1e9, highest = -1e9;
  for (const float v : world.values.values()) {
    lowest = std::min<double>(lowest, v);
    highest = std::max<double>(highest, v);
  }
  EXPECT_LE(t.to_world(t.box.lo).z, lowest - options.settings.influence - 40);
  EXPECT_GE(t.to_world(t.box.hi).z, highest + options.settings.influence);
}

TEST(MakeTerrain, MissingDataBecomesADistanceAndTheHeightsAreFinite) {
  raster::Raster world = hills(120, 100, far_away);
  for (int r = 0; r < 100; ++r)
    for (int c = 0; c < 40; ++c) world.values.at(c, r) = raster::no_data;
  const Terrain t = make_terrain(world, 0.5);
  ASSERT_NE(t.inside, nullptr);
  for (const float v : t.heights->values.values()) ASSERT_TRUE(std::isfinite(v));
  // The border lies between columns 39 and 40, 80 m from the west edge.
  EXPECT_FLOAT_EQ(t.inside->values.at(40, 50), 1);
  EXPECT_FLOAT_EQ(t.inside->values.at(39, 50), -1);
  EXPECT_FLOAT_EQ(t.inside->values.at(45, 50), 11);
  for (const float d : t.inside->values.values()) ASSERT_TRUE(std::isfinite(d));
  EXPECT_EQ(t.valid->at(39, 0), 0);
  EXPECT_EQ(t.valid->at(40, 0), 1);
  // What cannot hold any rock is left out of the box.
  EXPECT_DOUBLE_EQ(t.to_world(t.box.lo).x, 500'000 + 39 * 2);
}

TEST(MakeTerrain, ARaggedBorderBecomesASmoothOne) {
  // A coast at column 60 with teeth one and two pixels wide and up to 14 long, and crumbs before it.
  raster::Raster world = hills(120, 100, far_away);
  for (int r = 0; r < 100; ++r)
    for (int c = 0; c < 62; ++c) {
      const bool tooth = r % 5 == 0 && c > 62 - 3 * (r % 7);
      const bool crumb = c % 17 == 3 && r % 13 == 4;
      if (!tooth && !crumb) world.values.at(c, r) = raster::no_data;
    }
  const Terrain t = make_terrain(world, 0.5);
  int crossings = 0;
  for (int r = 0; r < 100; ++r)
    for (int c = 1; c < 120; ++c) crossings += t.valid->at(c - 1, r) != t.valid->at(c, r);
  EXPECT_EQ(crossings, 100);  // each row enters the land once
  double longest = 0;
  for (int r = 1; r < 100; ++r) {
    const auto coast = [&](int row) {
      int c = 0;
      while (!t.valid->at(c, row)) ++c;
      const double before = t.inside->at(c - 1, row), after = t.inside->at(c, row);
      return c - after / (after - before);
    };
    longest = std::max(longest, std::abs(coast(r) - coast(r - 1)));
    EXPECT_NEAR(coast(r), 61.5, 2);
  }
  EXPECT_LT(longest, 1);
}

TEST(MakeTerrain, AnIsletAloneIsKept) {
  raster::Raster world = hills(40, 40, far_away);
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c)
      if (std::hypot(c - 20, r - 20) > 3.5) world.values.at(c, r) = raster::no_data;
  const Terrain t = make_terrain(world, 0.5);
  EXPECT_EQ(t.valid->at(20, 20), 1);
  EXPECT_EQ(t.valid->at(27, 20), 0);
}

TEST(MakeTerrain, PolygonsWithHolesCutTheDomain) {
  const raster::Raster world = hills(120, 100, far_away);
  TerrainOptions options;
  const auto square = [](double x, double y, double half) {
    return std::vector<Vec2d>{
        {x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}};
  };
  options.polygons = {square(500'120, 5'900'100, 60.5), square(500'120, 5'900'100, 20)};
  const Terrain t = make_terrain(world, 0.5, options);
  const auto at = [&](double x, double y) {
    const Vec2d p = far_away.pixel(x, y);
    return t.inside->values.at(round_to(p.x), round_to(p.y));
  };
  EXPECT_FLOAT_EQ(at(500'061, 5'900'101), 1.5f);
  EXPECT_FLOAT_EQ(at(500'059, 5'900'101), -0.5f);
  EXPECT_FLOAT_EQ(at(500'099, 5'900'101), 1);
  EXPECT_LT(at(500'121, 5'900'101), -15);
  options.polygons = {square(0, 0, 10)};
  EXPECT_THAT(error_of([&] { make_terrain(world, 0.5, options); }),
              HasSubstr("does not cover any of the elevation model's data"));
}

TEST(MakeTerrain, Refuses) {
  raster::Raster world = hills(20, 20, far_away);
  EXPECT_THAT(error_of([&] { make_terrain(world, 0); }),
              HasSubstr("must be a positive number of metres, not 0."));
  EXPECT_THAT(error_of([&] { make_terrain(world, NAN); }),
              HasSubstr("must be a positive number of metres, not nan."));
  TerrainOptions options;
  options.settings.amplitude = 4.9;
  EXPECT_THAT(error_of([&] { make_terrain(world, 1, options); }),
              HasSubstr("R = 15 m must be positive and at most three times the amplitude T = 4.9 m"));
  for (float& v : world.values.values()) v = raster::no_data;
  EXPECT_THAT(error_of([&] { make_terrain(world, 1); }), HasSubstr("holds no data at all"));
}

TEST(TerrainTree, IsTheSmallerOfTheHeightfieldAndTheDomain) {
  raster::Raster world = hills(120, 100, far_away);
  for (int r = 0; r < 100; ++r)
    for (int c = 0; c < 40; ++c) world.values.at(c, r) = raster::no_data;
  TerrainOptions options;
  options.depth = 60;
  const Terrain t = make_terrain(world, 0.5, options);
  const field::HeightfieldSettings settings;
  const field::CompiledField f = field::compile(terrain_tree(t, settings));
  const auto value = [&](int col, int row, double above) {
    const Vec2d p = t.heights->placement.center(col, row);
    return f.value({p.x, p.y, t.heights->at(col, row) + above});
  };
  const auto T = static_cast<float>(settings.amplitude);
  EXPECT_NEAR(value(80, 50, 0), 0, 1e-4);
  EXPECT_FLOAT_EQ(value(80, 50, -20), T);
  EXPECT_FLOAT_EQ(value(80, 50, 20), -T);
  // Deep in the rock only the border counts: sigma(1 m) and sigma(-1 m).
  const double R = settings.influence, a = settings.amplitude;
  const double sigma = 1 + (3 * a - 2 * R) / (R * R) + (R - 2 * a) / (R * R * R);
  EXPECT_NEAR(value(40, 50, -25), sigma, 1e-4);
  EXPECT_NEAR(value(39, 50, -25), -sigma, 1e-4);
  EXPECT_FLOAT_EQ(f.value({0, 0, t.box.lo.z - R}), -T);
  EXPECT_NEAR(f.value({0, 0, t.box.lo.z}), 0, 1e-5);
}

}  // namespace
}  // namespace tafoni::terrain
