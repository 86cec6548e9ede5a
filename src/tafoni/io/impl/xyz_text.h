#pragma once
// Grids as lines of x, y and z: what GDAL takes for zero without a word.

#include <array>
#include <string>

#include "tafoni/io/impl/pixel_runs.h"

namespace tafoni::io::impl {

/// The pixels that no line names. `file` is as GDAL opens it, `name` for messages; `transform` is GDAL's.
/// Throws Error{input} where a word stands in place of x, y or z.
PixelRuns check_xyz_text(const std::string& file, const std::string& name,
                         const std::array<double, 6>& transform, int width, int height);

}  // namespace tafoni::io::impl
