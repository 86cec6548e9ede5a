#pragma once
// An elevation model from a formula.

#include "tafoni/raster/grid.h"

namespace tafoni::raster {

/// Holds height(x, y) at the centre of every pixel.
template <class Height>
Raster sampled(int width, int height_px, const Placement& placement, const Height& height) {
  Raster out{Grid<float>(width, height_px), placement, {}};
  for (int row = 0; row < height_px; ++row)
    for (int col = 0; col < width; ++col) {
      const Vec2d at = placement.center(col, row);
      out.values.at(col, row) = static_cast<float>(height(at.x, at.y));
    }
  return out;
}

}  // namespace tafoni::raster
