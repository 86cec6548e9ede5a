#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/stencil.h"
#include "tafoni/terrain/test/surfaces.h"

namespace tafoni::terrain {
namespace {

/// The largest tangent sphere that holds no point of any column, by bisection over all cells.
double brute_radius(const raster::Raster& terrain, int col, int row, double max_radius) {
  const Vec2d g = impl::gradient(terrain, col, row);
  const Vec3d n = normalized(Vec3d{-g.x, -g.y, 1});
  const double here = terrain.at(col, row);
  const auto free = [&](double r) {
    const Vec3d center = n * r;
    for (int y = 0; y < terrain.height(); ++y)
      for (int x = 0; x < terrain.width(); ++x) {
        const float h = terrain.values.at(x, y);
        if (std::isnan(h) || (x == col && y == row)) continue;
        const double dx = (x - col) * terrain.placement.dx - center.x;
        const double dy = (row - y) * terrain.placement.dy - center.y;
        const double dz = std::max(center.z - (h - here), 0.0);
        if (dx * dx + dy * dy + dz * dz < r * r) return false;
      }
    return true;
  };
  if (free(max_radius)) return max_radius;
  double lo = 0, hi = max_radius;
  for (int i = 0; i < 25; ++i) {
    const double middle = (lo + hi) / 2;
    (free(middle) ? lo : hi) = middle;
  }
  return lo;
}

TEST(Accessibility, IsTheSameWhereItIsWantedAndMissingElsewhere) {
  const auto terrain = rough(40, 33, 1, 0, 0.02);
  raster::Grid<std::uint8_t> wanted(40, 33, 0);
  for (int row = 5; row < 20; ++row)
    for (int col = row; col < 33; ++col) wanted.at(col, row) = 1;
  const auto all = accessibility(terrain, {.max_radius = 6}),
             some = accessibility(terrain, {.max_radius = 6, .wanted = &wanted});
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (wanted.values()[i] && !std::isnan(all.values()[i]))
      ASSERT_EQ(all.values()[i], some.values()[i]);
    else
      ASSERT_TRUE(std::isnan(some.values()[i]));
  }
}

TEST(Accessibility, AgreesWithBruteForce) {
  const auto hills = [](double x, double y) {
    return 6 * std::sin(x / 5) * std::cos(y / 7) + std::sin(x * 1.3 + y);
  };
  for (double radius : {0.7, 3.0, 11.0, 60.0})
    for (int which = 0; which < 4; ++which) {
      const auto terrain = which == 0   ? rough(25, 21, 1, 0, 0.03)
                           : which == 1 ? surface(25, 21, 1, 1, hills)
                           : which == 2
                               ? surface(25, 21, 0.5, 1.5, hills)
                               : surface(25, 21, 1, 1, [&](double x, double) { return x > 12 ? 25.0 : 0.0; });
      const auto open = accessibility(terrain, {.max_radius = radius});
      for (int row = 0; row < terrain.height(); row += 4)
        for (int col = 0; col < terrain.width(); ++col) {
          if (std::isnan(terrain.values.at(col, row))) {
            ASSERT_TRUE(std::isnan(open.at(col, row)));
            continue;
          }
          ASSERT_NEAR(open.at(col, row), brute_radius(terrain, col, row, radius) / radius, 2e-5)
              << radius << " " << which << " at " << col << ", " << row;
        }
    }
}

TEST(Accessibility, PlanesAndHilltopsAreOpen) {
  for (double steep : {0.0, 0.5, 4.0}) {
    const auto plane = surface(40, 40, 1, 1, [&](double x, double y) { return steep * (x - y); });
    const auto open = accessibility(plane);
    for (float v : open.values()) EXPECT_EQ(v, 1);
  }
  const auto hill = surface(41, 41, 1, 1, [](double x, double y) {
    return -((x - 20.5) * (x - 20.5) + (y - 20.5) * (y - 20.5)) / 30;
  });
  // One-sided slopes at the border tilt the tangent plane into the hill.
  const auto open = accessibility(hill);
  for (int row = 1; row < 40; ++row)
    for (int col = 1; col < 40; ++col) EXPECT_EQ(open.at(col, row), 1);
}

TEST(Accessibility, BottomOfAParaboloidHasItsRadiusOfCurvature) {
  for (double curvature : {4.0, 9.0}) {
    // As wide as the largest sphere that touches the bottom.
    const auto bowl = surface(101, 101, 0.2, 0.2, [&](double x, double y) {
      return ((x - 10.1) * (x - 10.1) + (y - 10.1) * (y - 10.1)) / (2 * curvature);
    });
    const auto open = accessibility(bowl, {.max_radius = 12});
    EXPECT_NEAR(12 * open.at(50, 50), curvature, 0.02 * curvature);
  }
}

TEST(Accessibility, SphericalBowlIsItsRadiusEverywhere) {
  const auto bowl = surface(121, 121, 0.25, 0.25, [](double x, double y) {
    const double r2 = (x - 15.125) * (x - 15.125) + (y - 15.125) * (y - 15.125);
    return r2 < 100 ? -std::sqrt(144 - r2) : -std::sqrt(44.0);
  });
  const auto open = accessibility(bowl, {.max_radius = 30});
  for (int col = 35; col <= 85; col += 5) EXPECT_NEAR(30 * open.at(col, 60), 12, 0.6) << col;
}

TEST(Accessibility, AWallOneRadiusAwayStopsASphere) {
  const auto wall = surface(101, 21, 1, 1, [](double x, double) { return x > 50 ? 500.0 : 0.0; });
  const auto open = accessibility(wall, {.max_radius = 40});
  // Column centres beyond the wall stand at x = 50.5: a sphere of radius r touches at distance r.
  for (int col = 15; col < 49; ++col) EXPECT_NEAR(40 * open.at(col, 10), 50.5 - (col + 0.5), 1e-3) << col;
  EXPECT_EQ(open.at(5, 10), 1);
}

TEST(Accessibility, DoesNotDependOnThreads) {
  const auto terrain = rough(64, 50, 5);
  set_thread_count(1);
  const auto one = accessibility(terrain);
  set_thread_count(2);
  const auto two = accessibility(terrain);
  set_thread_count(0);
  EXPECT_EQ(one.values(), two.values());
}

TEST(Accessibility, NeedsARadius) {
  EXPECT_EQ(error_of([&] { accessibility(rough(3, 3, 1), {.max_radius = 0}); }),
            "accessibility: the greatest radius must be above 0 m, not 0");
  EXPECT_EQ(error_of([&] { accessibility(rough(3, 3, 1), {.max_radius = NAN}); }),
            "accessibility: the greatest radius must be above 0 m, not nan");
}

}  // namespace
}  // namespace tafoni::terrain
