#pragma once
// Volumes out and in, in the format that the file's extension names (formats/).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "tafoni/core/progress.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::io {

/// A sampled field with its place in the world.
struct Volume {
  volume::ScalarGrid grid;
  Vec3d origin;  ///< world position of local zero
  MeshMetadata metadata;
};

/// Writes beside `path` and renames, so that no partial file is ever seen. Throws Error{output}.
void write_volume(const std::filesystem::path& path, const Volume& volume, Progress& progress = silent());

/// Throws Error{input}: missing, truncated, damaged, or a grid that cannot be held. Memory is bounded by what
/// the file can mean: some 256 MB and a thousand times its size.
Volume read_volume(const std::filesystem::path& path, Progress& progress = silent());
/// The same of a file that lies in memory; `file` tells its format and is named in messages.
Volume read_volume(std::span<const std::byte> bytes, const std::filesystem::path& file,
                   Progress& progress = silent());

/// What a volume's file holds.
struct VolumeInfo {
  volume::GridFrame frame;
  Vec3d origin;
  volume::Precision precision = volume::Precision::single;
  MeshMetadata metadata;
  Interval values = {};  ///< least and greatest
  std::int64_t chunks = 0;
  std::int64_t full_chunks = 0;      ///< that hold more than one value
  std::int64_t distinct_chunks = 0;  ///< of them that are like no earlier one
  std::uint64_t bytes = 0;           ///< of memory that it takes when it is read
};
/// Looks at every sample and keeps none. Throws as read_volume() does.
VolumeInfo inspect_volume(const std::filesystem::path& path, Progress& progress = silent());

}  // namespace tafoni::io
