#pragma once
// Mending elevations: the terraces of data stored in too coarse a unit.

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::raster {

/// The height of the steps in stepped data (8-bit, whole metres on gentle ground), in the grid's unit;
/// 0 when heights vary freely or neighbours mostly differ by several steps, so that no terraces show.
double detect_step(const Grid<float>& heights);

/// Removes the terraces of data quantized to `step`: a thin plate held within half a step of every height,
/// so true cliffs stay where they are. NaN stays NaN.
void remove_steps(Raster& raster, double step, Progress& progress = silent());

}  // namespace tafoni::raster
