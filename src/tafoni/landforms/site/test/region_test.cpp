#include "tafoni/landforms/site/region.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/math/draw.h"

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

/// An outline with bays, too long for a list, about the origin.
Ring star(double radius, int n) {
  Ring ring;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * 3.14159265358979 * i / n,
                 r = radius * (1 + 0.4 * std::sin(7 * t) + 0.1 * std::cos(31 * t));
    ring.push_back({r * std::cos(t), r * std::sin(t)});
  }
  return ring;
}

double distance_to(const Ring& ring, Vec3d p) {
  double best = 1e9;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Vec2d d = ring[j] - ring[i], to = Vec2d{p.x, p.y} - ring[i];
    const double t = std::clamp((d.x * to.x + d.y * to.y) / (d.x * d.x + d.y * d.y), 0.0, 1.0);
    best = std::min(best, std::hypot(to.x - t * d.x, to.y - t * d.y));
  }
  return best;
}

float value(const field::FunctionPtr& f, Vec3d p) {
  float out = 0;
  f->values({&p, 1}, {&out, 1});
  return out;
}

std::shared_ptr<raster::Raster> blotches() {
  auto mask = std::make_shared<raster::Raster>();
  mask->values = raster::Grid<float>(60, 50);
  mask->placement = {-45, 40, 1.5, 1.5};
  Random random(9);
  for (float& v : mask->values.values())
    v = random.uniform() < 0.04 ? raster::no_data : draw_float(random, -1, 2);
  return mask;
}

TEST(RegionFunction, OfNoRegionIsNullAndOfNoLimitsOne) {
  EXPECT_EQ(as_function(nullptr, 3), nullptr);
  const Region region;
  EXPECT_EQ(value(as_function(&region, 3), {4, 5, 6}), 1);
  EXPECT_EQ(as_function(&region, 3)->range({{0, 0, 0}, {9, 9, 9}}).lo, 1);
}

TEST(RegionFunction, RisesFromTheRingsAsFarAsTheyAre) {
  const std::vector<Ring> rings = {star(40, 500), square(0, 0, 6)};
  Region region;
  region.limit_polygon(rings);
  for (double fade : {0.0, 5.0}) {
    const auto f = as_function(&region, fade);
    Random random(4);
    for (int i = 0; i < 4000; ++i) {
      const Vec3d p{random.uniform(-65, 65), random.uniform(-65, 65), random.uniform(-5, 5)};
      const double d = std::min(distance_to(rings[0], p), distance_to(rings[1], p));
      const double t = fade > 0 ? std::min(d / fade, 1.0) : 1.0;
      const double expected = region.contains(p) ? t * t * (3 - 2 * t) : 0;
      ASSERT_NEAR(value(f, p), expected, 1e-6) << p.x << ' ' << p.y;
    }
  }
}

TEST(RegionFunction, IsZeroOutsideAndTheWeightWellInside) {
  Region region;
  region.limit_altitude(-8, 9);
  region.limit_box({{-30, -34, -50}, {36, 33, 50}});
  region.limit_polygon({star(35, 90)});
  region.limit_mask(blotches());
  const double fade = 4;
  const auto f = as_function(&region, fade);
  Random random(5);
  int outside = 0, inside = 0;
  for (int i = 0; i < 60000; ++i) {
    const Vec3d p{random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-12, 12)};
    const double v = value(f, p);
    if (!region.contains(p)) {
      ASSERT_EQ(v, 0);
      ++outside;
      continue;
    }
    ASSERT_LE(v, 1);
    if (p.z > -4 && p.z < 5 && std::abs(p.x) < 10 && std::abs(p.y) < 10 && v > 0) {
      // Beside pixels without data it is less.
      ASSERT_LE(v, region.weight(p) + 1e-6);
      ++inside;
    }
  }
  EXPECT_GT(outside, 1000);
  EXPECT_GT(inside, 300);
}

TEST(RegionFunction, IsContinuous) {
  Region region;
  region.limit_altitude(-8, 9);
  region.limit_box({{-30, -34, -50}, {36, 33, 50}});
  region.limit_polygon({star(35, 90)});
  region.limit_mask(blotches());
  const auto f = as_function(&region, 2);
  Random random(6);
  for (int i = 0; i < 40000; ++i) {
    const Vec3d p{random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-12, 12)};
    const Vec3d q = p + Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * 1e-3;
    // A mask falls by 3 at most over 1.5 m, the other factors by 1.5 / fade.
    ASSERT_NEAR(value(f, p), value(f, q), 0.02);
  }
}

TEST(RegionFunction, RangesEncloseAndPrune) {
  Region plain, whole;
  plain.limit_altitude(-8, 9);
  plain.limit_box({{-30, -34, -50}, {36, 33, 50}});
  plain.limit_polygon({star(35, 90), square(0, 0, 6)});
  whole = plain;
  whole.limit_mask(blotches());
  for (const Region* region : {&plain, &whole}) {
    const auto f = as_function(region, 3);
    Random random(7);
    int nothing = 0, empty = 0, full = 0, ones = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3d c{random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-20, 20)};
      const double half = 0.2 * std::pow(100, random.uniform());
      const Box3d box = Box3d{c, c}.grown(half);
      const Interval range = f->range(box);
      float most = 0, least = 1;
      for (int k = 0; k < 40; ++k) {
        const Vec3d p =
            c + Vec3d{random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
        const float v = value(f, p);
        ASSERT_TRUE(range.contains(v)) << v << " not in " << range.lo << ".." << range.hi;
        most = std::max(most, v);
        least = std::min(least, v);
      }
      empty += most == 0;
      nothing += range.lo == 0 && range.hi == 0;
      full += range.lo == 1;
      ones += least == 1;
    }
    EXPECT_GT(nothing, 0.9 * empty) << "boxes far outside are not told from others";
    if (region == &plain) {
      EXPECT_GE(full, 3);
      EXPECT_GT(full, 0.6 * ones);
    }
  }
}

}  // namespace
}  // namespace tafoni::landforms
