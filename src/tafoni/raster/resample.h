#pragma once
// Sampling a raster between its pixels and bringing it to another resolution. NaN pixels take no part.

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::raster {

/// Values at world positions; beyond the centres of the outermost pixels the nearest value continues.
/// NaN when the nearest pixel is NaN; other NaN neighbours are left out of the weights.
double sample_bilinear(const Raster& raster, double x, double y);
/// Catmull-Rom over 4 x 4 pixels, C1; bilinear where one of them is NaN.
double sample_bicubic(const Raster& raster, double x, double y);

enum class Resampling { bilinear, bicubic, average };

/// `source` on the grid of `placement`. `average` weighs every source pixel by its overlap with the target
/// pixel; a target pixel less than half covered by data is NaN.
Raster resample(const Raster& source, const Placement& placement, int width, int height, Resampling how,
                Progress& progress = silent());

/// Square pixels of `pixel` metres from the same north-west corner: averaged when coarser than the source,
/// bicubic when finer.
Raster at_resolution(const Raster& source, double pixel, Progress& progress = silent());

}  // namespace tafoni::raster
