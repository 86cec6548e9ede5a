#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/test/surfaces.h"

namespace tafoni::terrain {
namespace {

TEST(Slope, OfAPlaneIsExactAtBordersToo) {
  const auto plane = surface(20, 15, 2, 3, [](double x, double y) { return 0.75 * x - 1.0 * y; });
  const auto s = slope(plane);
  for (float v : s.values()) EXPECT_NEAR(v, 1.25, 1e-5);
}

TEST(Slope, OfAParabolaIsExactInside) {
  const auto bowl = surface(21, 5, 0.5, 0.5, [](double x, double) { return x * x; });
  const auto s = slope(bowl);
  for (int col = 1; col < 20; ++col) EXPECT_NEAR(s.at(col, 2), 2 * bowl.placement.center(col, 2).x, 1e-4);
}

TEST(Slope, LeavesMissingCellsOut) {
  auto plane = surface(5, 5, 1, 1, [](double x, double) { return 2 * x; });
  plane.values.at(2, 2) = raster::no_data;
  const auto s = slope(plane);
  EXPECT_TRUE(std::isnan(s.at(2, 2)));
  EXPECT_NEAR(s.at(1, 2), 2, 1e-6);
  EXPECT_NEAR(s.at(3, 2), 2, 1e-6);
  EXPECT_NEAR(s.at(2, 1), 2, 1e-6);
}

TEST(Slope, OfALoneCellIsZero) {
  EXPECT_EQ(slope(surface(1, 1, 1, 1, [](double, double) { return 5.0; })).at(0, 0), 0);
}

}  // namespace
}  // namespace tafoni::terrain
