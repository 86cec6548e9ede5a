// Makes a table, once: for every case of the marching cubes all ways to merge its triangles across diagonals,
// and the outlines that result. A voxel then looks for the first way all of whose polygons are convex and
// planar.

#include "tafoni/surface/impl/convex.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

#include "tafoni/surface/impl/cases.h"

namespace tafoni::surface::impl {
namespace {

constexpr int merges = 16;

struct Diagonal {
  std::size_t a, b;  ///< triangles
};

std::vector<Diagonal> diagonals(const CellCase& c) {
  std::vector<Diagonal> out;
  const auto edge = [&](std::size_t t, std::size_t corner) { return c.edges[3 * t + corner % 3]; };
  for (std::size_t a = 0; a < c.triangles; ++a)
    for (std::size_t b = a + 1; b < c.triangles; ++b)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          if (edge(a, i) == edge(b, j + 1) && edge(a, i + 1) == edge(b, j)) out.push_back({a, b});
  return out;
}

/// The outline of the triangles in `set`, which hang together: sides whose reverse none of them has.
void append_outline(const CellCase& c, unsigned set, ConvexPieces& out) {
  struct Side {
    std::size_t from;  ///< place
    int to;            ///< edge of the cell
  };
  std::vector<Side> sides;
  for (std::size_t t = 0; t < c.triangles; ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (set >> t & 1) sides.push_back({3 * t + i, c.edges[3 * t + (i + 1) % 3]});
  const auto inside = [&](const Side& s) {
    return std::any_of(sides.begin(), sides.end(), [&](const Side& other) {
      return c.edges[other.from] == s.to && other.to == c.edges[s.from];
    });
  };
  std::vector<Side> outline;
  std::copy_if(sides.begin(), sides.end(), std::back_inserter(outline),
               [&](const Side& s) { return !inside(s); });
  auto at = outline.begin();
  std::uint8_t& end = out.begin[out.count + 1];
  end = out.begin[out.count];
  for (std::size_t n = 0; n < outline.size(); ++n) {
    out.corners[end++] = static_cast<std::uint8_t>(at->from);
    at = std::find_if(outline.begin(), outline.end(),
                      [&](const Side& s) { return c.edges[s.from] == at->to; });
  }
  out.triangles[out.count++] = static_cast<std::uint8_t>(set);
}

ConvexPieces join(const CellCase& c, const std::vector<Diagonal>& all, int merge) {
  std::array<unsigned, 5> set{1, 2, 4, 8, 16};
  for (std::size_t d = 0; d < all.size(); ++d) {
    if (!(merge >> d & 1)) continue;
    const unsigned both = set[all[d].a] | set[all[d].b];
    for (std::size_t t = 0; t < 5; ++t)
      if (both >> t & 1) set[t] = both;
  }
  ConvexPieces out;
  for (int t = 0; t < c.triangles; ++t)
    if (std::countr_zero(set[t]) == t) append_outline(c, set[t], out);
  return out;
}

/// The corners of the two triangles beside a diagonal, around them; its ends are the first and the third.
using Quad = std::array<std::uint8_t, 4>;

Quad quad(const CellCase& c, const Diagonal& d) {
  const auto edge = [&](std::size_t t, std::size_t corner) { return c.edges[3 * t + corner % 3]; };
  const auto place = [](std::size_t t, std::size_t corner) {
    return static_cast<std::uint8_t>(3 * t + corner % 3);
  };
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (edge(d.a, i) == edge(d.b, j + 1) && edge(d.a, i + 1) == edge(d.b, j))
        return {place(d.a, i), place(d.b, j + 2), place(d.a, i + 1), place(d.a, i + 2)};
  return {};
}

struct Table {
  std::vector<ConvexPieces> pieces = std::vector<ConvexPieces>(256 * merges);
  std::array<int, 256> diagonals{};
  std::array<std::array<Quad, 4>, 256> quads{};
  std::array<std::uint8_t, merges> order{};  ///< merges of most diagonals first

  Table() {
    std::iota(order.begin(), order.end(), std::uint8_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [](std::uint8_t a, std::uint8_t b) { return std::popcount(a) > std::popcount(b); });
    for (std::size_t solid = 0; solid < 256; ++solid) {
      const CellCase& c = case_table()[solid];
      const auto all = impl::diagonals(c);
      diagonals[solid] = static_cast<int>(all.size());
      for (int m = 0; m < 1 << all.size(); ++m) pieces[solid * merges + m] = join(c, all, m);
      for (std::size_t d = 0; d < all.size(); ++d) quads[solid][d] = quad(c, all[d]);
    }
  }
};

const Table& merge_table() {
  static const Table made;
  return made;
}

bool convex_and_planar(const Vec3d* p, std::size_t n, double tolerance) {
  Vec3d spokes[7];
  for (std::size_t i = 0; i < n; ++i) spokes[i] = p[i] - p[0];
  Vec3d normal = cross(spokes[1], spokes[2]);
  for (std::size_t i = 2; i + 1 < n; ++i) normal += cross(spokes[i], spokes[i + 1]);
  double heights[7], middle = 0;
  Vec3d side = p[0] - p[n - 1];
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d next = p[i + 1 < n ? i + 1 : 0] - p[i];
    if (!(dot(cross(side, next), normal) >= 0)) return false;
    side = next;
    heights[i] = dot(spokes[i], normal);
    middle += heights[i];
  }
  middle /= static_cast<double>(n);
  const double most = tolerance * tolerance * dot(normal, normal);
  return std::all_of(heights, heights + n, [&](double h) { return (h - middle) * (h - middle) <= most; });
}

/// False where the corners of a convex polygon, four of them in order, cannot all be so near one plane: its
/// diagonals pass each other at more than twice the tolerance. A quick test that spares most voxels the rest.
bool may_be_planar(Vec3f a, Vec3f b, Vec3f c, Vec3f d, double tolerance) {
  const Vec3d p = to_double(c) - to_double(a), q = to_double(d) - to_double(b);
  const Vec3d normal = cross(p, q);
  const double apart = dot(to_double(b) - to_double(a), normal), most = 2.0001 * tolerance;
  return apart * apart <= most * most * dot(normal, normal);
}

}  // namespace

const ConvexPieces& convex_pieces(int solid, int merge) {
  return merge_table().pieces[solid * merges + merge];
}

int best_merge(int solid, const std::uint32_t* triangles, const Vec3f* positions, double tolerance) {
  const Table& t = merge_table();
  const int diagonals = t.diagonals[solid];
  int possible = 0;
  for (int d = 0; d < diagonals; ++d) {
    const Quad& q = t.quads[solid][d];
    const auto corner = [&](std::size_t i) { return positions[triangles[q[i]]]; };
    possible |= may_be_planar(corner(0), corner(1), corner(2), corner(3), tolerance) << d;
  }
  if (possible == 0) return 0;
  enum : std::uint8_t { unknown, good, bad };
  std::uint8_t known[32] = {};
  const auto fits = [&](const ConvexPieces& pieces, int piece) {
    std::uint8_t& state = known[pieces.triangles[piece]];
    const int begin = pieces.begin[piece], n = pieces.begin[piece + 1] - begin;
    if (n == 3) return true;
    if (state == unknown) {
      Vec3d corners[7];
      for (int i = 0; i < n; ++i) corners[i] = to_double(positions[triangles[pieces.corners[begin + i]]]);
      state = convex_and_planar(corners, n, tolerance) ? good : bad;
    }
    return state == good;
  };
  for (int merge : t.order) {
    if ((merge & ~possible) != 0) continue;
    const ConvexPieces& pieces = convex_pieces(solid, merge);
    int piece = 0;
    while (piece < pieces.count && fits(pieces, piece)) ++piece;
    if (piece == pieces.count) return merge;
  }
  return 0;
}

}  // namespace tafoni::surface::impl
