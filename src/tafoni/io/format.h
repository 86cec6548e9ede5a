#pragma once
// The formats of files: what each can, and which one an extension means. A format is one file in formats/.
// mesh_file.h, image_file.h and volume_file.h write and read by them.

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/registry.h"
#include "tafoni/raster/image.h"

namespace tafoni {
class AtomicFile;
class Progress;
namespace mesh {
struct Mesh;
}
}  // namespace tafoni

namespace tafoni::io {

struct MeshForm;
struct MeshMetadata;
struct Volume;
namespace impl {
struct VolumeSource;
}

/// What a mesh's file says and how it says it; the form has an axis that is up.
struct MeshOutput {
  const MeshMetadata& metadata;
  const MeshForm& form;
};

/// One file format. A function that the format lacks is null.
struct FormatType {
  Declaration about = {};
  std::vector<std::string> extensions = {};  ///< lower case, without the dot; the first is the usual one

  /// Writes the whole file; the caller commits it. The mesh has triangles. Throws Error{output}, also for a
  /// mesh that the format cannot hold.
  void (*write_mesh)(AtomicFile&, const mesh::Mesh&, const MeshOutput&, Progress&) = nullptr;
  /// Reads a whole file that lies in memory. `file` is for error texts. Throws Error{input}.
  mesh::Mesh (*read_mesh)(std::span<const std::byte> bytes, std::string_view file) = nullptr;
  void (*write_image)(AtomicFile&, const raster::Image&) = nullptr;
  /// Writes the whole file; the caller commits it. Throws Error{output}.
  void (*write_volume)(AtomicFile&, const Volume&, Progress&) = nullptr;
  /// Opens a whole file that lies in memory and outlives the result. Like read_mesh.
  impl::VolumeSource (*open_volume)(std::span<const std::byte> bytes, std::string_view file) = nullptr;
  bool texture = false;       ///< whether meshes keep their texture coordinates
  bool world = false;         ///< whether it holds positions in double
  bool float_colors = false;  ///< whether it holds colours as floats
  std::string ups = "z";      ///< the axes that can point up in a mesh, the usual one first
};

/// Every format, sorted by name; the table is written by CMake from the folder's files: formats/NAME.cpp
/// defines `const FormatType& declaration()` in its namespace `format_NAME`.
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

}  // namespace tafoni::io
