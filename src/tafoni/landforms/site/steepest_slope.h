#pragma once
// How steep a heightfield gets.

#include <algorithm>
#include <cmath>

#include "tafoni/raster/grid.h"

namespace tafoni::landforms::impl {

/// A bound on the slope, rise over run, of the smooth surface through the pixels along x and along y.
inline double steepest_slope(const raster::Raster& heights) {
  double most = 0;
  for (int row = 0; row < heights.height(); ++row)
    for (int col = 0; col < heights.width(); ++col) {
      const double z = heights.at(col, row);
      if (col > 0) most = std::max(most, std::abs(z - heights.at(col - 1, row)) / heights.placement.dx);
      if (row > 0) most = std::max(most, std::abs(z - heights.at(col, row - 1)) / heights.placement.dy);
    }
  return 2 * most;
}

}  // namespace tafoni::landforms::impl
