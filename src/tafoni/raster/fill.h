#pragma once
// Mending elevations: holes.

#include <cstddef>

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::raster {

struct FillReport {
  std::size_t filled = 0;  ///< pixels
  std::size_t left = 0;    ///< pixels still NaN
};

/// Fills every hole (4-connected NaN pixels) no pixel centre of which is farther than `distance` metres from
/// a pixel with data; others stay. The filling is a thin plate that meets its rim in height and slope;
/// at the raster's own rim a membrane.
FillReport fill_holes(Raster& raster, double distance, Progress& progress = silent());

/// Gives every NaN pixel a finite value that continues its surroundings without a step (a membrane, so
/// within the range of the data). Throws Error{input} when there is no data at all.
void fill_all(Raster& raster, Progress& progress = silent());

}  // namespace tafoni::raster
