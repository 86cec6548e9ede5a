#pragma once
// Sampled fields as level sets: distances in metres to the surface that is meshed.

#include "tafoni/core/progress.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::surface {

/// How far, in cells, distances() may reach.
inline constexpr int most_distance = 14;

/// For each sample the distance to the nearest triangle of polygonize_grid(), above 0 where the grid's value
/// is and below 0 elsewhere, limited to +-`reach` metres. So every sample keeps its side, whatever the values
/// are. The result's precision is `precision`; it takes memory only near the surface. The same at any thread
/// count. Throws Error{usage} unless `reach` is above 0 and at most `most_distance` cells.
volume::ScalarGrid distances(const volume::ScalarGrid& grid, double reach, volume::Precision precision,
                             Progress& progress = silent());

}  // namespace tafoni::surface
