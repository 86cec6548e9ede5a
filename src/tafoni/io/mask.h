#pragma once
// Masks from raster files: how strongly something acts at each place, from 0 for not at all to 1 for wholly.

#include <filesystem>
#include <string>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::io {

struct MaskFile {
  raster::Raster raster;           ///< NaN where the file has no data; metres where it is placed, else pixels
  bool placed = false;             ///< whether the file says where it lies
  std::vector<std::string> notes;  ///< every assumption, one sentence each; also sent to warn()
};

/// Whole numbers up to 1 are weights as they stand; larger ones are shares of the greatest that 8 or 16 bits
/// hold, as painting programs write them: 255 or 65535 is 1. Floats are weights. Marks of missing data count
/// where the file tags them alone: white is no such mark. `crs` is where to bring a placed mask, WKT; empty:
/// its own. Throws Error{input} for what is no mask.
MaskFile read_mask(const std::filesystem::path& path, const std::string& crs, Progress& progress = silent());

}  // namespace tafoni::io
