#pragma once
// Polygons in: GeoJSON, GeoPackage, Shapefile and whatever else OGR reads.

#include <filesystem>
#include <string>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::io {

/// The rings of every polygon in every layer, in world coordinates of `crs` (WKT), first vertex not
/// repeated; holes and islands by the even-odd rule. Polygons that overlap are united first, so that what any
/// of them covers is inside. A file without a CRS is taken to be in `crs`, and so is
/// a GeoJSON without a "crs" member whose coordinates cannot be degrees. An empty `crs` takes coordinates as
/// they are, and a local one, which lies nowhere on Earth, does so of GeoJSON in degrees: that is what it
/// says of drawings, too. Curves are flattened. Throws Error{input}: no file, no polygons, not finite, not
/// transformable.
std::vector<std::vector<Vec2d>> read_polygons(const std::filesystem::path& path, const std::string& crs);

}  // namespace tafoni::io
