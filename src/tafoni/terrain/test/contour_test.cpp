#include "tafoni/terrain/impl/contour.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tafoni/terrain/test/surfaces.h"

namespace tafoni::terrain {
namespace {

double distance(const impl::Contour& contour, const raster::Raster& grid, int col, int row) {
  const auto i = contour.nearest.at(col, row);
  if (i < 0) return std::numeric_limits<double>::infinity();
  const Vec2d p = grid.placement.center(col, row), q = contour.points[i];
  return std::hypot(p.x - q.x, p.y - q.y);
}

TEST(Contour, DistanceToACircle) {
  const auto grid =
      surface(160, 120, 0.5, 0.5, [](double x, double y) { return 20 - std::hypot(x - 40, y - 30); });
  const auto contour = impl::trace_contour(grid);
  for (int row = 0; row < 120; ++row)
    for (int col = 0; col < 160; ++col)
      ASSERT_NEAR(distance(contour, grid, col, row), std::abs(grid.values.at(col, row)), 0.12);
}

TEST(Contour, NearestIsAlmostTheNearestOfAllPoints) {
  const auto grid =
      surface(50, 40, 1, 2, [](double x, double y) { return std::sin(x / 4) + std::cos(y / 9) - 0.8; });
  const auto contour = impl::trace_contour(grid);
  for (int row = 0; row < 40; ++row)
    for (int col = 0; col < 50; ++col) {
      const Vec2d p = grid.placement.center(col, row);
      double least = std::numeric_limits<double>::infinity();
      for (const Vec2d q : contour.points) least = std::min(least, std::hypot(p.x - q.x, p.y - q.y));
      ASSERT_GE(distance(contour, grid, col, row), least);
      ASSERT_LE(distance(contour, grid, col, row), least + 0.5);
    }
}

TEST(Contour, PointsLieOnTheLine) {
  const auto grid = surface(30, 30, 1, 1, [](double x, double y) { return x + 2 * y - 41; });
  const auto contour = impl::trace_contour(grid);
  ASSERT_FALSE(contour.points.empty());
  for (const Vec2d p : contour.points) EXPECT_NEAR(p.x + 2 * p.y, 41, 1e-5);
}

TEST(Contour, WithoutALineNothingIsNearest) {
  const auto contour = impl::trace_contour(surface(5, 4, 1, 1, [](double, double) { return 1.0; }));
  EXPECT_TRUE(contour.points.empty());
  for (auto i : contour.nearest.values()) EXPECT_EQ(i, -1);
}

}  // namespace
}  // namespace tafoni::terrain
