#pragma once
// Signed distances to the border of a mask or a polygon.

#include <cstdint>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::raster {

/// The exact Euclidean distance in metres from each pixel's centre to the border between pixels (taken as
/// boxes dx by dy) where `mask` is non-zero and where it is zero; positive where non-zero. The raster's rim
/// is no border. All one kind: +-infinity. Linear time [Felzenszwalb12].
Grid<float> signed_distance(const Grid<std::uint8_t>& mask, double dx, double dy,
                            Progress& progress = silent());

/// The signed distance in metres to the rings (world coordinates, even-odd rule, positive inside), exact
/// within `band` metres of them; farther away at least the band, with the right sign.
Grid<float> signed_distance(const std::vector<std::vector<Vec2d>>& rings, const Placement& placement,
                            int width, int height, double band, Progress& progress = silent());

}  // namespace tafoni::raster
