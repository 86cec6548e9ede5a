#pragma once
// Texture coordinates of corners for formats that keep them in a list or at vertices.

#include <array>
#include <cstdint>
#include <vector>

#include "tafoni/mesh/mesh.h"

namespace tafoni::io::impl {

/// Each pair of coordinates once a vertex, in the order of the vertices, and which of them each corner has.
struct Seams {
  std::vector<Vec2<float>> pairs;
  std::vector<std::uint32_t> vertex;  ///< that each pair belongs to
  std::vector<std::array<std::uint32_t, 3>> corners;

  /// All members are empty for a mesh without texture coordinates.
  explicit Seams(const mesh::Mesh& mesh);
};

/// The other way: gives corners the pairs of their vertices, and joins vertices that stand one after the
/// other and differ in nothing but their pairs.
void join_seams(mesh::Mesh& mesh, const std::vector<Vec2<float>>& pairs);

}  // namespace tafoni::io::impl
