#pragma once
// The grids of an OpenVDB file: their names, metadata and places, and the trees of those that hold floats.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/io/impl/vdb_tree.h"

namespace tafoni::io::impl {

/// Names with a type's name and the value's bytes.
class VdbMetadata {
 public:
  VdbMetadata() = default;
  explicit VdbMetadata(VdbBytes& in);

  /// Empty where there is none.
  std::string text(std::string_view name) const;
  bool flag(std::string_view name) const;
  std::optional<Vec3d> place(std::string_view name) const;
  std::optional<Vec3i> size(std::string_view name) const;

 private:
  std::span<const std::byte> find(std::string_view name, std::string_view type, std::size_t size) const;
  struct Entry {
    std::string_view type;
    std::span<const std::byte> value;
  };
  std::map<std::string_view, Entry> entries_;
};

/// A grid of floats, whose tree has not been read.
struct VdbGrid {
  std::string name;
  VdbMetadata metadata;
  VdbCoding coding;
  std::string refused;      ///< why it cannot be read; then what follows is not known
  double spacing = 0;       ///< the side of its cubes
  Vec3d origin = {};        ///< where voxel (0, 0, 0) lies
  std::size_t tree_at = 0;  ///< 0 where it is not known
};

struct VdbFile {
  VdbMetadata metadata;
  std::vector<VdbGrid> grids;
  std::vector<std::string> others;  ///< types of the grids that are not of floats
};

/// `bytes` must outlive the result. Throws Error{input}: of another format or version, damaged, or with a
/// grid that cannot be stepped over.
VdbFile read_vdb_file(std::span<const std::byte> bytes, std::string_view file);

}  // namespace tafoni::io::impl
