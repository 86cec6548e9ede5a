#pragma once
// Meshes out and in, in the format that the file's extension names (formats/).

#include <filesystem>
#include <string>

#include "tafoni/core/params.h"
#include "tafoni/core/progress.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::io {

/// What the file of a mesh or a volume says besides its geometry, as far as its format can.
struct MeshMetadata {
  std::string name = "terrain";
  std::string crs = {};   ///< WKT or "EPSG:…"; empty when unknown
  Values generator = {};  ///< how it was made: scene parameters, seed, versions
};

/// Writes beside `path` and renames, so that no partial file is ever seen. Throws Error{output}.
void write_mesh(const std::filesystem::path& path, const mesh::Mesh& mesh, const MeshMetadata& metadata = {},
                Progress& progress = silent());

/// Throws Error{input}: missing, truncated, or not what its extension says. The result's indices are in range
/// and its positions finite; formats without shared vertices (STL) are welded by exact position.
mesh::Mesh read_mesh(const std::filesystem::path& path);

}  // namespace tafoni::io
