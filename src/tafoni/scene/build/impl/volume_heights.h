#pragma once
// The upper surface of a volume, for scenes that take a volume as their terrain.

#include "tafoni/io/volume_file.h"
#include "tafoni/raster/grid.h"

namespace tafoni::scene::impl {

/// The volume's upper surface, world coordinates, one pixel a column of cells; the frame's floor where a
/// column holds no rock.
raster::Raster heights_of(const io::Volume& volume);

}  // namespace tafoni::scene::impl
