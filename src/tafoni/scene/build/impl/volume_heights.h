#pragma once
// The upper surface of a volume, for scenes that take a volume as their terrain.

#include <string_view>

#include "tafoni/io/volume_file.h"
#include "tafoni/raster/grid.h"

namespace tafoni::scene::impl {

/// The volume's upper surface, world coordinates, one pixel a column of cells; the frame's floor where a
/// column holds no rock. Throws Error{usage} that begins with `file` when they do not fit this machine, since
/// a file of few bytes can have any number of columns.
raster::Raster heights_of(const io::Volume& volume, std::string_view file);

}  // namespace tafoni::scene::impl
