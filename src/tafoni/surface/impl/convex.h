#pragma once
// The triangles of a cell joined to convex planar polygons.

#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni::surface::impl {

/// A case's triangles, some joined: corners are places among the case's triangle corners.
struct ConvexPieces {
  std::uint8_t count = 0;          ///< of polygons, at most 5
  std::uint8_t begin[6] = {};      ///< first corner of each, and the end
  std::uint8_t triangles[5] = {};  ///< of each, as bits
  std::uint8_t corners[15] = {};
};

/// `merge`: bits of the diagonals (sides that two triangles of the case share, at most 4) to join across.
const ConvexPieces& convex_pieces(int solid, int merge);

/// The merge that leaves the fewest pieces, all convex and with corners within `tolerance` of one plane; the
/// lowest of several. `triangles`: the vertices of the case's triangles.
int best_merge(int solid, const std::uint32_t* triangles, const Vec3f* positions, double tolerance);

}  // namespace tafoni::surface::impl
