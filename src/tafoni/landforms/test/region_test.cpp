#include "tafoni/landforms/region.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"

namespace tafoni::landforms {
namespace {

Ring square(double x, double y, double half) {
  return {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}};
}

TEST(Region, WithoutLimitsIsEverywhere) {
  const Region region;
  EXPECT_EQ(region.weight({1e6, -1e6, 1e4}), 1);
  EXPECT_TRUE(std::isinf(region.bounds().hi.x));
}

TEST(Region, AltitudeAndBoxIntersect) {
  Region region;
  region.limit_altitude(-2, 8);
  region.limit_box({{0, 0, 0}, {10, 10, 100}});
  EXPECT_TRUE(region.contains({5, 5, 8}));
  EXPECT_FALSE(region.contains({5, 5, 8.1}));
  EXPECT_FALSE(region.contains({5, 5, -1}));
  EXPECT_FALSE(region.contains({-0.1, 5, 4}));
  EXPECT_EQ(region.bounds().lo.z, 0);
  EXPECT_EQ(region.bounds().hi.z, 8);
}

TEST(Region, PolygonHasHolesAndIslandsByTheEvenOddRule) {
  Region region;
  region.limit_polygon({square(0, 0, 10), square(0, 0, 5), square(0, 0, 2), square(40, 0, 3)});
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p{random.uniform(-20, 50), random.uniform(-20, 20), random.uniform(-9, 9)};
    const double ring = std::max(std::abs(p.x), std::abs(p.y));
    const bool expected =
        (ring < 10 && ring > 5) || ring < 2 || (std::abs(p.x - 40) < 3 && std::abs(p.y) < 3);
    ASSERT_EQ(region.contains(p), expected) << p.x << ' ' << p.y;
  }
  EXPECT_EQ(region.bounds().lo.x, -10);
  EXPECT_EQ(region.bounds().hi.x, 43);
}

TEST(Region, PolygonWithoutVerticesHoldsNothing) {
  Region region;
  region.limit_polygon({{}});
  EXPECT_FALSE(region.contains({0, 0, 0}));
  EXPECT_TRUE(region.bounds().empty());
}

TEST(Region, MaskIsBilinearClampedAndZeroOutsideOrWithoutData) {
  auto mask = std::make_shared<raster::Raster>();
  mask->values = raster::Grid<float>(4, 3, 0.f);
  mask->placement = {100, 50, 2, 2};
  mask->values.at(1, 1) = 1;
  mask->values.at(2, 1) = 4;
  mask->values.at(0, 0) = raster::no_data;
  Region region;
  region.limit_mask(mask);
  EXPECT_NEAR(region.weight({103, 47, 0}), 1, 1e-12);
  EXPECT_NEAR(region.weight({103, 46, 0}), 0.5, 1e-12);
  EXPECT_EQ(region.weight({105, 47, 0}), 1) << "values above one count as one";
  EXPECT_EQ(region.weight({100.5, 49.5, 0}), 0) << "no data";
  EXPECT_EQ(region.weight({99.9, 47, 0}), 0);
  EXPECT_EQ(region.weight({103, 43.9, 0}), 0);
  EXPECT_EQ(region.bounds().lo.x, 100);
  EXPECT_EQ(region.bounds().lo.y, 44);
}

}  // namespace
}  // namespace tafoni::landforms
