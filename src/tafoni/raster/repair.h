#pragma once
// Mending elevations: holes, terraces of stepped data.

#include <cstddef>

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::raster {

struct FillReport {
  std::size_t filled = 0;  ///< pixels
  std::size_t left = 0;    ///< pixels still NaN
};

/// Fills every hole (4-connected NaN pixels) no pixel centre of which is farther than `distance` metres from
/// a pixel with data; others stay. The filling is a thin plate that meets its rim in height and slope.
FillReport fill_holes(Raster& raster, double distance, Progress& progress = silent());

/// Gives every NaN pixel a finite value that continues its surroundings without a step (a membrane, so
/// within the range of the data). Throws Error{input} when there is no data at all.
void fill_all(Raster& raster, Progress& progress = silent());

/// The height of the steps in stepped data (8-bit, whole metres on gentle ground), in the raster's unit;
/// 0 when heights vary freely or most neighbours differ by several steps.
double detect_step(const Grid<float>& heights);

/// Removes the terraces of data quantized to `step`: a smooth surface that stays within half a step of every
/// height, so true cliffs stay where they are.
void remove_steps(Raster& raster, double step, Progress& progress = silent());

}  // namespace tafoni::raster
