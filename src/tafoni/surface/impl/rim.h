#pragma once
// Normals that agree with the triangles around their vertices, also where those belong to several pieces.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "tafoni/surface/impl/piece.h"

namespace tafoni::surface::impl {

/// The rim of a piece are the vertices that others may have, too: those on its six faces, in order, then
/// those of its corners. Where a face's begin; the corners' for 6.
std::size_t rim_begin(const Piece& piece, int face);
inline std::size_t rim_size(const Piece& piece) {
  return rim_begin(piece, 6) + piece.corners.size();
}

/// Sets piece.rim, which has room, from the sums about all vertices.
void note_rim(Piece& piece, double voxel, const FacetFour* facets);
/// Makes the normals that are not on the rim agree with the sums about their vertices. Soon after the piece
/// was made, while it is in the cache. The rim's sums are set to zero.
void settle_inside(Piece& piece, FacetFour* facets);

/// Chunk columns [x0, x1) x [y0, y1): a tile.
struct ChunkColumns {
  int x0, x1, y0, y1;
  std::int64_t count() const { return std::int64_t{x1 - x0} * (y1 - y0); }
};

/// The sums about the vertices on the seams between tiles, from the pieces on both sides.
class SeamSums {
 public:
  void add(const Piece& piece, const ChunkColumns& tile);
  /// Puts the sums of vertices on seams in place of the piece's own.
  void complete(Piece& piece) const;

 private:
  std::unordered_map<LatticeEdge, FacetSum, LatticeEdgeHash> sums_;
};

/// Makes the normals of the rim agree with the sums about it.
void settle_rim(Piece& piece, double voxel);

}  // namespace tafoni::surface::impl
