#pragma once
// Normals that agree with the triangles around their vertices, also where those belong to several pieces.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "tafoni/surface/impl/piece.h"

namespace tafoni::surface::impl {

/// The triangles around a vertex (mesh/inner/facets.h), in units of voxel^2 / 2^30: whole numbers, whose sum
/// does not depend on the order.
using FacetSum = Vec3<std::int64_t>;

/// The rim of a piece are the vertices that others may have, too: those on its six faces, in order, then
/// those of its corners. Where a face's begin; the corners' for 6.
std::size_t rim_begin(const Piece& piece, int face);

/// Makes the normals inside agree with the piece's triangles, if it has normals, and returns what these give
/// the rim.
std::vector<FacetSum> settle_inside(Piece& piece, double voxel);

/// Chunk columns [x0, x1) x [y0, y1): a tile.
struct ChunkColumns {
  int x0, x1, y0, y1;
  std::int64_t count() const { return std::int64_t{x1 - x0} * (y1 - y0); }
};

/// The sums about the vertices on the seams between tiles, from the pieces on both sides.
class SeamSums {
 public:
  /// `rim` is what settle_inside() gave.
  void add(const Piece& piece, std::span<const FacetSum> rim, const ChunkColumns& tile);
  /// Puts the sums of vertices on seams in place of the piece's own.
  void complete(const Piece& piece, std::span<FacetSum> rim) const;

 private:
  std::unordered_map<LatticeEdge, FacetSum, LatticeEdgeHash> sums_;
};

/// Makes the normals of the rim agree with the sums about it.
void settle_rim(Piece& piece, std::span<const FacetSum> rim, double voxel);

}  // namespace tafoni::surface::impl
