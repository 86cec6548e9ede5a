#pragma once
// Distance to the zero line of a function on a grid.

#include <cstdint>
#include <vector>

#include "tafoni/raster/grid.h"

namespace tafoni::terrain::impl {

struct Contour {
  std::vector<Vec2d> points;           ///< on the line, in the placement's frame
  raster::Grid<std::int32_t> nearest;  ///< index of the nearest point; -1 everywhere when there is no line
};

/// Finds where `values` changes sign between neighbouring cells, by linear interpolation, and each cell's
/// nearest such point, by propagating it over the grid [Danielsson80], which errs by a small part of a
/// pixel. `values` must be finite.
Contour trace_contour(const raster::Raster& values);

}  // namespace tafoni::terrain::impl
