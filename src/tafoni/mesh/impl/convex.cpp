#include "tafoni/mesh/impl/convex.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "tafoni/mesh/impl/cases.h"

namespace tafoni::mesh::impl {
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
  for (std::size_t t = 0; t < c.triangles; ++t)
    if (std::countr_zero(set[t]) == static_cast<int>(t)) append_outline(c, set[t], out);
  return out;
}

struct Table {
  std::vector<ConvexPieces> pieces = std::vector<ConvexPieces>(256 * merges);
  std::array<int, 256> diagonals{};
  std::array<std::uint8_t, merges> order{};  ///< merges of most diagonals first

  Table() {
    for (std::size_t m = 0; m < merges; ++m) order[m] = static_cast<std::uint8_t>(m);
    std::stable_sort(order.begin(), order.end(),
                     [](std::uint8_t a, std::uint8_t b) { return std::popcount(a) > std::popcount(b); });
    for (std::size_t solid = 0; solid < 256; ++solid) {
      const CellCase& c = case_table()[solid];
      const auto all = impl::diagonals(c);
      diagonals[solid] = static_cast<int>(all.size());
      for (int m = 0; m < 1 << all.size(); ++m)
        pieces[solid * merges + static_cast<std::size_t>(m)] = join(c, all, m);
    }
  }
};

const Table& table() {
  static const Table made;
  return made;
}

bool convex_and_planar(const Vec3d* p, std::size_t n, double tolerance) {
  Vec3d area, middle;
  for (std::size_t i = 0; i < n; ++i) {
    area += cross(p[i] - p[0], p[(i + 1) % n] - p[0]);
    middle += p[i];
  }
  const Vec3d normal = normalized(area);
  middle = middle * (1.0 / static_cast<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    if (!(std::abs(dot(normal, p[i] - middle)) <= tolerance)) return false;
    const Vec3d in = p[(i + 1) % n] - p[i], out = p[(i + 2) % n] - p[(i + 1) % n];
    if (!(dot(cross(in, out), normal) >= 0)) return false;
  }
  return true;
}

}  // namespace

const ConvexPieces& convex_pieces(int solid, int merge) {
  return table().pieces[static_cast<std::size_t>(solid * merges + merge)];
}

int best_merge(int solid, const std::uint32_t* triangles, const Vec3f* positions, double tolerance) {
  const int diagonals = table().diagonals[static_cast<std::size_t>(solid)];
  if (diagonals == 0) return 0;
  enum : std::uint8_t { unknown, good, bad };
  std::uint8_t known[32] = {};
  const auto fits = [&](const ConvexPieces& pieces, int piece) {
    std::uint8_t& state = known[pieces.triangles[piece]];
    const int begin = pieces.begin[piece], n = pieces.begin[piece + 1] - begin;
    if (n == 3) return true;
    if (state == unknown) {
      Vec3d corners[7];
      for (int i = 0; i < n; ++i) corners[i] = to_double(positions[triangles[pieces.corners[begin + i]]]);
      state = convex_and_planar(corners, static_cast<std::size_t>(n), tolerance) ? good : bad;
    }
    return state == good;
  };
  for (int merge : table().order) {
    if (merge >= 1 << diagonals) continue;
    const ConvexPieces& pieces = convex_pieces(solid, merge);
    int piece = 0;
    while (piece < pieces.count && fits(pieces, piece)) ++piece;
    if (piece == pieces.count) return merge;
  }
  return 0;
}

}  // namespace tafoni::mesh::impl
