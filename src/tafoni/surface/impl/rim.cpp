// Sums facet vectors over a piece's triangles. Vertices inside are settled at once; what the rim got is kept
// as whole numbers, which neighbours, and the tiles beyond a seam, add to.

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

/// Sets each vertex's sum of facet vectors (mesh/inner/facets.h), a vector at once.
void add_facets(const Piece& piece, SettleScratch& out) {
  if (out.size() < piece.positions.size()) out.resize(piece.positions.size());
  for (std::size_t v = 0; v < piece.positions.size(); ++v) {
    const Vec3f& p = piece.positions[v];
    using Four = FacetVertex::Four;
    out[v] = {Four{p.x, p.y, p.z, 0}, Four{p.y, p.z, p.x, 0}, Four{}};
  }
  for (const auto& t : piece.triangles) {
    FacetVertex &a = out[t[0]], &b = out[t[1]], &c = out[t[2]];
    const auto facet = (b.at - a.at) * (c.next - a.next) - (b.next - a.next) * (c.at - a.at);
    a.sum += facet;
    b.sum += facet;
    c.sum += facet;
  }
}

}  // namespace

std::size_t rim_begin(const Piece& piece, int face) {
  std::size_t begin = 0;
  for (int f = 0; f < face; ++f) begin += piece.faces[f].size();
  return begin;
}

void settle_inside(Piece& piece, double voxel, SettleScratch& scratch) {
  add_facets(piece, scratch);
  const auto take = [&](std::size_t vertex) {
    const FacetVertex::Four& sum = scratch[vertex].sum;
    return Vec3f{sum[1], sum[2], sum[0]};
  };
  piece.rim.clear();
  piece.rim.reserve(rim_begin(piece, 6) + piece.corners.size());
  const double scale = units(voxel);
  for_each_on_rim(piece, [&](std::size_t, std::uint32_t vertex, const LatticeEdge&) {
    const Vec3d sum = to_double(take(vertex)) * scale;
    piece.rim.push_back({std::llround(sum.x), std::llround(sum.y), std::llround(sum.z)});
    scratch[vertex].sum = FacetVertex::Four{};  // the inside is settled without it
  });
  for (std::size_t v = 0; v < piece.normals.size(); ++v)
    piece.normals[v] = mesh::inner::agreeing(piece.normals[v], take(v));
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
