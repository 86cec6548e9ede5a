#pragma once
// A picture: 8-bit sRGB with alpha, row 0 at the top.

#include <array>
#include <cstdint>

#include "tafoni/raster/grid.h"

namespace tafoni::raster {

using Image = Grid<std::array<std::uint8_t, 4>>;

}  // namespace tafoni::raster
