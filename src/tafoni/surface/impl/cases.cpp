// Makes the case table at compile time: walks the faces of the cell, on each of which a segment cuts off
// every run of solid corners, joins the segments to loops, and triangulates each loop with the shortest
// diagonals that lie in no face.

#include "tafoni/surface/impl/cases.h"

#include <limits>
#include <span>

namespace tafoni::surface::impl {
namespace {

constexpr int edge_of(int corner, int other) {
  const int axis_bit = corner ^ other;
  const int low = corner & other;
  const int x = low & 1, y = (low >> 1) & 1, z = low >> 2;
  return axis_bit == 1 ? y + 2 * z : axis_bit == 2 ? 4 + x + 2 * z : 8 + x + 2 * y;
}

/// Coordinates of an edge's midpoint, doubled.
constexpr std::array<int, 3> midpoint(int edge) {
  const int a = edge & 1, b = (edge >> 1) & 1;
  return edge < 4   ? std::array{1, 2 * a, 2 * b}
         : edge < 8 ? std::array{2 * a, 1, 2 * b}
                    : std::array{2 * a, 2 * b, 1};
}

constexpr bool share_face(int a, int b) {
  const auto p = midpoint(a), q = midpoint(b);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (p[axis] == q[axis] && p[axis] != 1) return true;
  return false;
}

constexpr int squared_distance(int a, int b) {
  const auto p = midpoint(a), q = midpoint(b);
  int sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) sum += (p[axis] - q[axis]) * (p[axis] - q[axis]);
  return sum;
}

/// The corners of a face, counter-clockwise seen from outside the cell.
constexpr std::array<int, 4> ring_of(int axis, int side) {
  const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3), base = side << axis;
  return side ? std::array{base, base + u, base + u + v, base + v}
              : std::array{base, base + v, base + u + v, base + u};
}

/// The edge that follows each cut edge around the surface piece, or -1.
constexpr std::array<int, 12> successors(int solid) {
  std::array<int, 12> next{};
  next.fill(-1);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto ring = ring_of(axis, side);
      const auto is_solid = [&](int at) { return (solid >> ring[at & 3]) & 1; };
      const auto edge_at = [&](int at) { return edge_of(ring[at & 3], ring[(at + 1) & 3]); };
      // Every run of solid corners along the ring is cut off by one segment.
      for (int first = 0; first < 4; ++first) {
        if (!is_solid(first) || is_solid(first + 3)) continue;
        int last = first;
        while (is_solid(last + 1)) ++last;
        next[edge_at(first + 3)] = edge_at(last);
      }
    }
  return next;
}

constexpr int never = std::numeric_limits<int>::max() / 4;

/// Triangulates a loop with the shortest diagonals, none within a face of the cell, by dynamic programming.
struct Triangulation {
  std::span<const int> loop;
  int n = 0;  ///< edges of the loop
  int cost[8][8] = {};
  int apex[8][8] = {};

  constexpr int diagonal(int a, int b) const {
    if (b - a < 2 || (a == 0 && b == n - 1)) return 0;
    const int p = loop[a], q = loop[b];
    return share_face(p, q) ? never : squared_distance(p, q);
  }
  constexpr void solve() {
    for (int width = 2; width < n; ++width)
      for (int a = 0; a + width < n; ++a) {
        const int b = a + width;
        cost[a][b] = never;
        for (int m = a + 1; m < b; ++m) {
          const int c = cost[a][m] + cost[m][b] + diagonal(a, m) + diagonal(m, b);
          if (c < cost[a][b]) cost[a][b] = c, apex[a][b] = m;
        }
      }
  }
  constexpr void emit(int a, int b, CellCase& out) const {
    if (b - a < 2) return;
    const int m = apex[a][b];
    const int corners[3] = {a, m, b};
    for (std::size_t c = 0; c < 3; ++c)
      out.edges[3u * out.triangles + c] = static_cast<std::uint8_t>(loop[corners[c]]);
    ++out.triangles;
    emit(a, m, out);
    emit(m, b, out);
  }
};

constexpr CellCase make_case(int solid) {
  CellCase out;
  auto next = successors(solid);
  for (int start = 0; start < 12; ++start) {
    std::array<int, 7> loop{};
    int n = 0;
    for (int e = start; next[e] >= 0;) {
      loop[n++] = e;
      const int following = next[e];
      next[e] = -1;
      e = following;
    }
    if (n == 0) continue;
    Triangulation t{{loop.data(), loop.data() + n}, n};
    t.solve();
    t.emit(0, n - 1, out);
  }
  return out;
}

constexpr CaseTable make_table() {
  CaseTable table;
  for (int solid = 0; solid < 256; ++solid) table[solid] = make_case(solid);
  return table;
}

constexpr CaseTable table = make_table();

}  // namespace

const CaseTable& case_table() {
  return table;
}

}  // namespace tafoni::surface::impl
