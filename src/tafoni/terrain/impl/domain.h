#pragma once
// Where a terrain is: from missing data and polygons to a signed distance with a border worth walking along.

#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::terrain::impl {

/// The signed distance in metres, positive inside, to the border of the data: NaN pixels are outside. The
/// border is smoothed over about two pixels, since that of a survey is ragged and every tooth of it would
/// become a pillar; islands of data nowhere more than four pixels from the border are left out, unless there
/// is nothing else; data too small to be smoothed keeps its own border. Empty when all is inside.
raster::Grid<float> data_distance(const raster::Raster& world, Progress& progress);

/// data_distance cut by polygons (world coordinates, even-odd rule, exact), limited to +-`band` metres.
raster::Grid<float> domain_distance(const raster::Raster& world,
                                    const std::vector<std::vector<Vec2d>>& polygons, double band,
                                    Progress& progress);

}  // namespace tafoni::terrain::impl
