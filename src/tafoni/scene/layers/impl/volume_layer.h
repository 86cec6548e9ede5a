#pragma once
// Volumes in a scene: as a layer, and as the terrain itself.

#include <string>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/raster/grid.h"

namespace tafoni::scene::impl {

struct VolumeSettings {
  std::string file;
  std::string mode = "replace";
  std::vector<double> at;  ///< world position of the middle of its box; empty: where the file says
};
const std::vector<ParamInfo>& volume_params();

/// What a layer of the volume does to the tree. `origin` is the world position of the scene's local zero,
/// `amplitude` its T: a volume saturates at its band, a scene at T, so values near the band are stretched.
landforms::Result place_volume(const io::Volume& volume, const VolumeSettings& settings, Vec3d origin,
                               double amplitude);

/// The volume's upper surface, world coordinates, one pixel a column of cells; the frame's floor where a
/// column holds no rock.
raster::Raster heights_of(const io::Volume& volume);

}  // namespace tafoni::scene::impl
