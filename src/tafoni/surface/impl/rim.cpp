// Vertices inside a piece are settled at once by the facets about them; what the rim got is kept as whole
// numbers, which neighbours, and the tiles beyond a seam, add to.

#include "tafoni/surface/impl/rim.h"

#include <cmath>

#include "tafoni/mesh/inner/facets.h"

namespace tafoni::surface::impl {
namespace {

constexpr int chunk_side = field::chunk_cells;

/// FacetSum's units a square metre.
double units(double voxel) {
  return 0x1p30 / (voxel * voxel);
}

/// Half away from zero.
std::int64_t nearest(double x) {
  return static_cast<std::int64_t>(x + std::copysign(0.5, x));
}

/// The edge of a vertex on a face; the inverse of PieceMaker::note_border.
LatticeEdge edge_on_face(const Piece& piece, int face, std::uint32_t place) {
  const int face_axis = face / 2, fixed = face % 2 ? chunk_side : 0;
  const int width = face_axis == 0 ? 1 : chunk_side + 1;
  const int i = face_axis == 0 ? fixed : static_cast<int>(place % width);
  const int row = static_cast<int>(place / width), axis = row % 3, line = row / 3;
  const Vec3i at = face_axis == 0   ? Vec3i{i, line % (chunk_side + 1), line / (chunk_side + 1)}
                   : face_axis == 1 ? Vec3i{i, fixed, line}
                                    : Vec3i{i, line, fixed};
  return {piece.chunk * chunk_side + at, axis};
}

/// Calls body(place in the rim, vertex, edge).
template <class Body>
void for_each_on_rim(const Piece& piece, const Body& body) {
  std::size_t at = 0;
  for (int face = 0; face < 6; ++face)
    for (const BorderVertex& v : piece.faces[face]) body(at++, v.vertex, edge_on_face(piece, face, v.place));
  for (const CornerVertex& v : piece.corners) body(at++, v.vertex, v.edge);
}

Vec3f vector_of(const FacetFour& sum) {
  return {sum[1], sum[2], sum[0]};
}

/// Of four vertices.
Vec3<Four> vectors_of(const FacetFour* s) {
  const Four zx01 = __builtin_shufflevector(s[0], s[1], 0, 4, 1, 5);
  const Four zx23 = __builtin_shufflevector(s[2], s[3], 0, 4, 1, 5);
  const Four y01 = __builtin_shufflevector(s[0], s[1], 2, 6, 2, 6);
  const Four y23 = __builtin_shufflevector(s[2], s[3], 2, 6, 2, 6);
  return {__builtin_shufflevector(zx01, zx23, 2, 3, 6, 7), __builtin_shufflevector(y01, y23, 0, 1, 4, 5),
          __builtin_shufflevector(zx01, zx23, 0, 1, 4, 5)};
}

}  // namespace

std::size_t rim_begin(const Piece& piece, int face) {
  std::size_t begin = 0;
  for (int f = 0; f < face; ++f) begin += piece.faces[f].size();
  return begin;
}

void note_rim(Piece& piece, double voxel, const FacetFour* facets) {
  const double scale = units(voxel);
  for_each_on_rim(piece, [&](std::size_t at, std::uint32_t vertex, const LatticeEdge&) {
    const Vec3d sum = to_double(vector_of(facets[vertex])) * scale;
    piece.rim[at] = {nearest(sum.x), nearest(sum.y), nearest(sum.z)};
  });
}

void settle_inside(Piece& piece, FacetFour* facets) {
  for_each_on_rim(
      piece, [&](std::size_t, std::uint32_t vertex, const LatticeEdge&) { facets[vertex] = FacetFour{}; });
  const std::span<Vec3f> normals = piece.normals;
  // Few normals disagree with their triangles: four are looked at together.
  std::size_t v = 0;
  for (; v + 4 <= normals.size(); v += 4) {
    const auto wrong = mesh::inner::disagree(load_vectors(&normals[v]), vectors_of(&facets[v]));
    for (std::size_t k = 0; k < 4; ++k)
      if (wrong[k]) normals[v + k] = normalized(vector_of(facets[v + k]));
  }
  for (; v < normals.size(); ++v) normals[v] = mesh::inner::agreeing(normals[v], vector_of(facets[v]));
}

void settle_rim(Piece& piece, double voxel) {
  if (piece.normals.empty()) return;
  const double scale = 1 / units(voxel);
  for_each_on_rim(piece, [&](std::size_t at, std::uint32_t vertex, const LatticeEdge&) {
    const FacetSum& sum = piece.rim[at];
    const Vec3d facet =
        Vec3d{static_cast<double>(sum.x), static_cast<double>(sum.y), static_cast<double>(sum.z)} * scale;
    piece.normals[vertex] = mesh::inner::agreeing(piece.normals[vertex], to_float(facet));
  });
}

void SeamSums::add(const Piece& piece, const ChunkColumns& tile) {
  const int x0 = tile.x0 * chunk_side, x1 = tile.x1 * chunk_side, y0 = tile.y0 * chunk_side,
            y1 = tile.y1 * chunk_side;
  for_each_on_rim(piece, [&](std::size_t at, std::uint32_t, const LatticeEdge& edge) {
    const bool on_x = edge.axis != 0 && (edge.at.x == x0 || edge.at.x == x1);
    const bool on_y = edge.axis != 1 && (edge.at.y == y0 || edge.at.y == y1);
    if (on_x || on_y) sums_[edge] += piece.rim[at];
  });
}

void SeamSums::complete(Piece& piece) const {
  if (sums_.empty()) return;
  for_each_on_rim(piece, [&](std::size_t at, std::uint32_t, const LatticeEdge& edge) {
    const auto found = sums_.find(edge);
    if (found != sums_.end()) piece.rim[at] = found->second;
  });
}

}  // namespace tafoni::surface::impl
