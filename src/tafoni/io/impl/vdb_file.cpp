// A file is: 8 bytes of magic number; its version, and the library's in two; whether grids tell where they
// are; 36 letters of identity; metadata; and the grids. Each has a unique name, its type, and the name of the
// grid whose tree it shares, if it does; where it, its values, and the next grid begin, which is of no
// meaning where grids do not tell; then flags of compression, metadata, a transform and, if the tree is its
// own, the tree.

#include "tafoni/io/impl/vdb_file.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"

namespace tafoni::io::impl {
namespace {

constexpr std::int64_t vdb_magic = 0x56444220;
/// The versions whose trees are laid out as vdb_tree.cpp knows them: those of OpenVDB 2.3 to 12.
constexpr std::uint32_t first_version = 222, last_version = 224;
constexpr std::size_t identity_letters = 36;
constexpr std::string_view float_type = "Tree_float_5_4_3", half_ending = "_HalfFloat";
/// Parts of a cell's side: what a transform is off by less is rounding.
constexpr double same_side = 1e-6;

/// A transform as a matrix that is multiplied from the left by (i, j, k, 1).
struct VdbTransform {
  double m[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  void scale(Vec3d by) { m[0][0] = by.x, m[1][1] = by.y, m[2][2] = by.z; }
  void move(Vec3d by) { m[3][0] = by.x, m[3][1] = by.y, m[3][2] = by.z; }
};

/// None where the transform is of a kind whose length is not known.
std::optional<VdbTransform> read_transform(VdbBytes& in) {
  const std::string_view type = in.text();
  VdbTransform out;
  const bool moved = type.ends_with("TranslateMap") || type == "TranslationMap";
  if (type == "AffineMap" || type == "UnitaryMap") {
    for (auto& row : out.m)
      for (double& v : row) v = in.get<double>();
  } else if (type == "TranslationMap" || type == "ScaleMap" || type == "UniformScaleMap" ||
             type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap") {
    if (moved) out.move(in.get<Vec3d>());
    if (type == "TranslationMap") return out;
    out.scale(in.get<Vec3d>());
    in.take(4 * sizeof(Vec3d));  // the cell's size and reciprocals, which follow from it
  } else {
    return {};
  }
  return out;
}

void take_place(const std::optional<VdbTransform>& transform, VdbGrid& grid) {
  if (!transform) {
    grid.refused =
        "its cells are no cubes but lie in a frustum or the like; resample it to cubes along the axes.";
    return;
  }
  const auto& m = transform->m;
  const double spacing = m[0][0];
  bool plain = spacing > 0 && std::isfinite(spacing);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k)
      plain = plain && std::abs(m[i][k] - (i == k ? spacing : 0)) <= same_side * spacing;
  if (!plain || std::abs(m[3][3] - 1) > same_side) {
    grid.refused =
        "its grid is turned, mirrored or has cells of unequal sides; resample it to cubes along the axes.";
    return;
  }
  grid.spacing = spacing;
  grid.origin = {m[3][0], m[3][1], m[3][2]};
}

/// What stands before a grid.
struct Descriptor {
  std::string name, type, parent;
  bool half = false;
  std::uint64_t end = 0;  ///< of no meaning where grids do not tell

  Descriptor(VdbBytes& in, bool places) {
    name = in.text(), type = in.text(), parent = in.text();
    if (type.ends_with(half_ending)) half = true, type.resize(type.size() - half_ending.size());
    const auto begin = in.get<std::uint64_t>();
    in.get<std::uint64_t>();  // where the values begin, which the tree says too
    end = in.get<std::uint64_t>();
    if (!places) return;
    if (begin < in.position() || end < begin) in.damaged("its grids do not stand one after the other");
    in.seek(begin);
  }

  /// The name without what makes it unique.
  std::string plain_name() const { return name.substr(0, name.find('\x1e')); }
};

VdbGrid read_grid(VdbBytes& in, const Descriptor& descriptor) {
  VdbGrid out;
  out.name = descriptor.plain_name();
  out.coding.flags = in.get<std::uint32_t>();
  out.metadata = VdbMetadata(in);
  out.coding.half = descriptor.half || out.metadata.flag("is_saved_as_half_float");
  const std::optional<VdbTransform> transform = read_transform(in);
  take_place(transform, out);
  if (transform) out.tree_at = in.position();
  return out;
}

}  // namespace

VdbMetadata::VdbMetadata(VdbBytes& in) {
  const auto count = in.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string_view name = in.text(), type = in.text();
    entries_[name] = {type, in.take(in.get<std::uint32_t>())};
  }
}

std::span<const std::byte> VdbMetadata::find(std::string_view name, std::string_view type,
                                             std::size_t size) const {
  const auto entry = entries_.find(name);
  if (entry == entries_.end() || entry->second.type != type) return {};
  if (size != 0 && entry->second.value.size() != size) return {};
  return entry->second.value;
}

std::string VdbMetadata::text(std::string_view name) const {
  return std::string(as_text(find(name, "string", 0)));
}
bool VdbMetadata::flag(std::string_view name) const {
  const auto value = find(name, "bool", 1);
  return !value.empty() && value[0] != std::byte{0};
}
std::optional<Vec3d> VdbMetadata::place(std::string_view name) const {
  const auto value = find(name, "vec3d", sizeof(Vec3d));
  return value.empty() ? std::nullopt : std::optional(load<Vec3d>(value, 0));
}
std::optional<Vec3i> VdbMetadata::size(std::string_view name) const {
  const auto value = find(name, "vec3i", sizeof(Vec3i));
  return value.empty() ? std::nullopt : std::optional(load<Vec3i>(value, 0));
}

VdbFile read_vdb_file(std::span<const std::byte> bytes, std::string_view file) {
  VdbBytes in(bytes, file);
  if (bytes.size() < sizeof vdb_magic || in.get<std::int64_t>() != vdb_magic)
    fail(ErrorKind::input, "{}: does not begin as an OpenVDB file does; it is of another format or cut off.",
         file);
  if (const auto version = in.get<std::uint32_t>(); version < first_version || version > last_version)
    fail(ErrorKind::input,
         "{}: has version {} of the OpenVDB format, and this program reads {} to {}; write it again with "
         "another OpenVDB.",
         file, version, first_version, last_version);
  in.take(2 * sizeof(std::uint32_t));  // the library's version
  const bool places = in.get<std::uint8_t>() != 0;
  in.take(identity_letters);
  VdbFile out;
  out.metadata = VdbMetadata(in);
  std::map<std::string, std::size_t> tree_of;
  const auto count = in.get<std::int32_t>();
  for (std::int32_t i = 0; i < count; ++i) {
    const Descriptor descriptor(in, places);
    bool known_end = places;
    if (descriptor.type == float_type) {
      VdbGrid grid = read_grid(in, descriptor);
      if (descriptor.parent.empty()) {
        tree_of[descriptor.name] = grid.tree_at;
        known_end = known_end || grid.tree_at != 0;
        if (!places && known_end && i + 1 < count) VdbTree(in, grid.coding);
      } else {
        const auto parent = tree_of.find(descriptor.parent);
        if (parent == tree_of.end()) in.damaged("a grid shares the tree of one that is not there");
        grid.tree_at = parent->second;
        known_end = true;
      }
      out.grids.push_back(std::move(grid));
    } else {
      out.others.push_back(descriptor.type);
    }
    if (!known_end && i + 1 < count)
      fail(ErrorKind::input,
           "{}: its grid {} is of a kind that cannot be read, and it does not say where that ends; write the "
           "grid of floats alone.",
           file, descriptor.plain_name());
    if (places) in.seek(descriptor.end);
  }
  return out;
}

}  // namespace tafoni::io::impl
