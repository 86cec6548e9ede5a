#pragma once
// Pictures out, in the format that the file's extension names (formats/).

#include <filesystem>

#include "tafoni/raster/image.h"

namespace tafoni::io {

/// Writes beside `path` and renames, so that no partial file is ever seen. Throws Error{output}.
void write_image(const std::filesystem::path& path, const raster::Image& image);

}  // namespace tafoni::io
