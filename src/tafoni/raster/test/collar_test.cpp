#include "tafoni/raster/collar.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace tafoni::raster {
namespace {

/// Hills of 300 m and more within a circle, zeros around it.
Grid<float> island(float shore) {
  Grid<float> out(40, 30, 0);
  for (int row = 0; row < 30; ++row)
    for (int col = 0; col < 40; ++col)
      if (const double r = std::hypot(col - 20, row - 15); r < 13)
        out.at(col, row) = static_cast<float>(shore + 10 * (13 - r));
  return out;
}
std::size_t missing(const Grid<float>& grid) {
  std::size_t count = 0;
  for (const float h : grid.values()) count += std::isnan(h);
  return count;
}

TEST(Collar, ZerosBesideHighGroundAloneAreMissing) {
  Grid<float> grid = island(300);
  const auto zeros = static_cast<std::size_t>(std::count(grid.values().begin(), grid.values().end(), 0.f));
  grid.at(20, 15) = 0;  // a hole, not a collar
  const Collar collar = remove_collar(grid, 0, 100);
  EXPECT_EQ(collar.pixels, zeros);
  EXPECT_EQ(missing(grid), zeros);
  EXPECT_GE(collar.lowest_beside, 300);
  EXPECT_LT(collar.lowest_beside, 310);
  EXPECT_EQ(grid.at(20, 15), 0);
}

TEST(Collar, ASeaHasAShoreSomewhere) {
  Grid<float> grid = island(300);
  for (int col = 20; col < 40; ++col) grid.at(col, 15) = 330 - 17.f * static_cast<float>(col - 20);
  EXPECT_EQ(remove_collar(grid, 0, 100).pixels, 0u);
  EXPECT_EQ(missing(grid), 0u);
}

TEST(Collar, WhatIsAllZeroOrAFewPixelsStays) {
  Grid<float> flat(20, 20, 0), corner(20, 20, 500);
  for (int i = 0; i < 3; ++i) corner.at(i, 0) = 0;
  EXPECT_EQ(remove_collar(flat, 0, 100).pixels, 0u);
  EXPECT_EQ(remove_collar(corner, 0, 100).pixels, 0u);
}

}  // namespace
}  // namespace tafoni::raster
