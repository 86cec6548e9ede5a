#pragma once
// Meshes out and in, in the format that the file's extension names (formats/).

#include <cstddef>
#include <filesystem>
#include <span>
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

/// How a mesh is laid down in its file. FormatType says what each format can.
struct MeshForm {
  /// The axis that points up, 'y' or 'z'; 0 for what is usual in the format. With y up, x is east and z
  /// south.
  char up = 0;
  bool world = false;         ///< positions are doubles in the CRS, in place of floats about an origin
  bool float_colors = false;  ///< linear colours as floats; some programs misread bytes
};

/// Writes through an AtomicFile, so that no partial file is ever seen. Throws Error{output}; Error{usage}
/// for a form that the format lacks.
void write_mesh(const std::filesystem::path& path, const mesh::Mesh& mesh, const MeshMetadata& metadata = {},
                Progress& progress = silent(), const MeshForm& form = {});

/// Throws Error{input}: missing, truncated, or not what its extension says. The result's indices are in range
/// and its positions finite; formats without shared vertices (STL) are welded by exact position. Files of
/// this program say which axis points up; of others GLB has y up, and the rest is taken to have z up.
mesh::Mesh read_mesh(const std::filesystem::path& path);
/// The same for a whole file that lies in memory. `name` has the extension, and is for error texts.
mesh::Mesh read_mesh(std::span<const std::byte> bytes, const std::string& name);

}  // namespace tafoni::io
