#pragma once
// The first stages of a build: elevations, the terrain with its field, the geology. Each is a plain function
// of what its key is made of (memo.h).

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/tree.h"
#include "tafoni/geology/geology.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/raster/grid.h"
#include "tafoni/scene/build/impl/memo.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/terrain/terrain.h"

namespace tafoni::scene {

// By what they say in a scene file.
void add_part(impl::Digest& to, const TerrainSection& words);
void add_part(impl::Digest& to, const GeologySettings& words);
void add_part(impl::Digest& to, const Layer& words);

namespace impl {

using RasterPtr = std::shared_ptr<const raster::Raster>;
using VolumePtr = std::shared_ptr<const io::Volume>;

/// What helps stages and layers to make what they make, and changes none of it.
struct Readers {
  using Volumes = Memo<VolumePtr, Progress, File>;
  Progress& progress;
  Volumes& volumes;

  VolumePtr volume(const File& file) { return volumes(file, progress).value; }
};
VolumePtr read_volume_file(const File& file, Progress& progress);

/// Whether the elevations are the upper surface of a volume.
bool is_volume(const TerrainSection& words);

/// What [terrain] says of the elevations, and what it says of their field; all else is as in an empty one.
TerrainSection words_of_elevations(const TerrainSection& words);
TerrainSection words_of_field(const TerrainSection& words);

/// `seed` is 0 for what is read; `source` is empty for what a generator makes.
RasterPtr make_elevations(const TerrainSection& words, const std::uint64_t& seed,
                          const std::optional<File>& source, Readers& readers);

struct Ground {
  terrain::Terrain terrain;
  field::HeightfieldSettings settings;
  field::NodePtr open;
};
Ground make_ground(const Keyed<RasterPtr>& elevations, const TerrainSection& words, const double& voxel,
                   const std::optional<File>& domain, Progress& progress);

/// The blend of all, or the default where there is none.
geology::GeologyPtr make_geology(const std::vector<GeologySettings>& words, const std::uint64_t& seed,
                                 const Vec3d& origin, Progress& progress);

}  // namespace impl
}  // namespace tafoni::scene
