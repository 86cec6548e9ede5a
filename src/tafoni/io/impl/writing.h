#pragma once
// What the writers share: output in blocks, so that a mesh is never held twice and Ctrl-C acts at once.

#include <bit>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/progress.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/math/vec.h"

namespace tafoni::io::impl {

static_assert(std::endian::native == std::endian::little, "the binary formats here are little-endian");

inline constexpr std::size_t items_per_block = 1u << 15;

/// Appends a value's bytes.
template <class T>
void put(std::string& block, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t at = block.size();
  block.resize(at + sizeof(T));
  std::memcpy(block.data() + at, &value, sizeof(T));
}

/// append(block, i) for i in [0, n), written block by block; one progress step an item.
template <class Append>
void write_items(AtomicFile& out, std::size_t n, Progress& progress, Append&& append) {
  std::string block;
  for (std::size_t begin = 0; begin < n; begin += items_per_block) {
    const std::size_t end = std::min(n, begin + items_per_block);
    block.clear();
    for (std::size_t i = begin; i < end; ++i) append(block, i);
    out.write(block);
    progress.advance(end - begin);
  }
}

/// World coordinates as text that reads back to the same doubles.
std::string origin_text(Vec3d origin);
/// Reads what origin_text wrote, found after `key` in `text`.
std::optional<Vec3d> find_origin(std::string_view text, std::string_view key);

/// One line: control characters become spaces, for headers that end at a line break.
std::string one_line(std::string_view text);
/// One line of ASCII, for formats whose headers can hold nothing else; other characters become '?'.
std::string ascii_line(std::string_view text);

/// East, north, up to x right, y up, z towards the viewer: a rotation, so triangles keep their turn.
template <class T>
constexpr Vec3<T> y_up(Vec3<T> p) {
  return {p.x, p.z, T(0) - p.y};
}
/// And back.
template <class T>
constexpr Vec3<T> z_up(Vec3<T> p) {
  return {p.x, T(0) - p.z, p.y};
}

/// What headers of text say of the axes, and whether one says that y points up.
std::string axes_text(const MeshForm& form);
bool says_y_up(std::string_view header);

/// 8-bit linear light to sRGB in [0, 1], and back; OBJ and PLY colours are sRGB by convention.
float srgb_from_linear(std::uint8_t linear);
std::uint8_t linear_from_srgb(double srgb);

}  // namespace tafoni::io::impl
