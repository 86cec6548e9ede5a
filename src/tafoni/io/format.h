#pragma once
// Files of meshes, pictures and volumes, by extension. A format is one file in formats/.

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/progress.h"
#include "tafoni/core/registry.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/raster/image.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::io {

/// What the file of a mesh or a volume says besides its geometry, as far as its format can.
struct MeshMetadata {
  std::string name = "terrain";
  std::string crs;   ///< WKT or "EPSG:…"; empty when unknown
  Values generator;  ///< how it was made: scene parameters, seed, versions
};

/// A sampled field with its place in the world.
struct Volume {
  volume::ScalarGrid grid;
  Vec3d origin;  ///< world position of local zero
  MeshMetadata metadata;
};

/// One file format. A function that the format lacks is null.
struct FormatType {
  Declaration about = {};
  std::vector<std::string> extensions = {};  ///< lower case, without the dot; the first is the usual one

  /// Writes the whole file; the caller commits it. The mesh has triangles. Throws Error{output}, also for a
  /// mesh that the format cannot hold.
  void (*write_mesh)(AtomicFile&, const mesh::Mesh&, const MeshMetadata&, Progress&) = nullptr;
  /// Reads a whole file that lies in memory. `file` is for error texts. Throws Error{input}.
  mesh::Mesh (*read_mesh)(std::span<const std::byte> bytes, std::string_view file) = nullptr;
  void (*write_image)(AtomicFile&, const raster::Image&) = nullptr;
  /// Writes the whole file; the caller commits it. Throws Error{output}.
  void (*write_volume)(AtomicFile&, const Volume&, Progress&) = nullptr;
  /// Like read_mesh. Every sample is finite.
  Volume (*read_volume)(std::span<const std::byte> bytes, std::string_view file, Progress&) = nullptr;
  bool texture = false;  ///< whether meshes keep their texture coordinates
};

/// Every format, sorted by name; the table is written by CMake from the folder's files: formats/NAME.cpp
/// defines `const FormatType& format_NAME()`.
std::span<const FormatType* const> all_formats();
/// Throws Error{usage} naming the nearest known one.
const FormatType& find_format(std::string_view name);

/// What a format is wanted for.
enum class Ability { write_mesh, read_mesh, write_image, write_volume, read_volume };
/// Whether some format of `path`'s extension can.
bool can(const std::filesystem::path& path, Ability ability);
/// The format of `path` by its extension, with the first of the abilities that it has. Throws Error{usage}
/// that lists the extensions that can.
const FormatType& format_of(const std::filesystem::path& path, std::initializer_list<Ability> abilities);
inline const FormatType& format_of(const std::filesystem::path& path, Ability ability) {
  return format_of(path, {ability});
}

/// Writes beside `path` and renames, so that no partial file is ever seen. Throws Error{output}.
void write_mesh(const std::filesystem::path& path, const mesh::Mesh& mesh, const MeshMetadata& metadata = {},
                Progress& progress = silent());
/// Throws Error{input}: missing, truncated, or not what its extension says. The result's indices are in range
/// and its positions finite; formats without shared vertices (STL) are welded by exact position.
mesh::Mesh read_mesh(const std::filesystem::path& path);
/// Writes beside `path` and renames. Throws Error{output}.
void write_image(const std::filesystem::path& path, const raster::Image& image);
/// Writes beside `path` and renames. Throws Error{output}.
void write_volume(const std::filesystem::path& path, const Volume& volume, Progress& progress = silent());
/// Throws Error{input}: missing, truncated, damaged, or a grid that cannot be held.
Volume read_volume(const std::filesystem::path& path, Progress& progress = silent());

}  // namespace tafoni::io
