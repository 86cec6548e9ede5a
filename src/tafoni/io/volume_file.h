#pragma once
// Volumes out and in, in the format that the file's extension names (formats/).

#include <filesystem>

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

/// Throws Error{input}: missing, truncated, damaged, or a grid that cannot be held.
Volume read_volume(const std::filesystem::path& path, Progress& progress = silent());

}  // namespace tafoni::io
