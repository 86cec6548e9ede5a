#pragma once
// An indexed triangle mesh. Positions are metres relative to `origin`; triangles are counter-clockwise seen
// from the air, that is, oriented outward.

#include <array>
#include <cstdint>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::mesh {

struct Mesh {
  Vec3d origin;                                     ///< world position (scene CRS) of local zero
  std::vector<Vec3f> positions;                     ///< metres, relative to origin
  std::vector<Vec3f> normals;                       ///< unit, outward; empty or one a position
  std::vector<std::array<std::uint8_t, 4>> colors;  ///< linear RGBA; empty or one a position
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Texture coordinates; empty or one a triangle's corner, so that seams need no vertices of their own.
  std::vector<std::array<Vec2<float>, 3>> texture;
};

}  // namespace tafoni::mesh
