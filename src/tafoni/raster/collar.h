#pragma once
// Zeros about an elevation model that was turned or cut without a mark for missing data.

#include <cstddef>

#include "tafoni/raster/grid.h"

namespace tafoni::raster {

struct Collar {
  std::size_t pixels = 0;    ///< that are NaN now; 0 where there is no collar
  double lowest_beside = 0;  ///< metres from `value`: the least of the heights that touch it
};

/// Pixels of exactly `value` that hang together with the grid's border, over edges, and whose every neighbour
/// lies farther than `limit` metres from it: they are set to NaN. A sea ends in a shore somewhere, a collar
/// nowhere. Fewer than 16 pixels in a piece are left.
Collar remove_collar(Grid<float>& heights, float value, double limit);

}  // namespace tafoni::raster
