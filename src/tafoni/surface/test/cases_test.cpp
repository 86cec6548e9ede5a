#include "tafoni/surface/impl/cases.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "tafoni/core/random.h"

namespace tafoni::surface::impl {
namespace {

struct Edge {
  int low, high;  ///< corners
};
Edge edge(int e) {
  const int a = e & 1, b = (e >> 1) & 1;
  if (e < 4) return {2 * a + 4 * b, 1 + 2 * a + 4 * b};
  if (e < 8) return {a + 4 * b, 2 + a + 4 * b};
  return {a + 2 * b, 4 + a + 2 * b};
}
bool solid(int c, int corner) {
  return (c >> corner) & 1;
}

using Segment = std::pair<int, int>;

/// Directed edges of a case's triangles that no other of its triangles runs back along.
std::set<Segment> rim(const CellCase& cell) {
  std::multiset<Segment> all;
  for (unsigned t = 0; t < cell.triangles; ++t)
    for (unsigned c = 0; c < 3; ++c) all.insert({cell.edges[3 * t + c], cell.edges[3 * t + (c + 1) % 3]});
  std::set<Segment> out;
  for (const Segment& s : all) {
    EXPECT_EQ(all.count(s), 1u);
    if (!all.count({s.second, s.first})) out.insert(s);
  }
  return out;
}

/// 0..5 (x low, x high, …) of the face both edges lie in, or -1.
int common_face(int a, int b) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto on = [&](int e) {
        return ((edge(e).low >> axis) & 1) == side && ((edge(e).high >> axis) & 1) == side;
      };
      if (on(a) && on(b)) return 2 * axis + side;
    }
  return -1;
}

TEST(Cases, UseEveryCutEdgeAndNoOther) {
  for (int c = 0; c < 256; ++c) {
    const CellCase& cell = case_table()[c];
    const std::set<int> used(cell.edges.begin(), cell.edges.begin() + 3 * cell.triangles);
    for (int e = 0; e < 12; ++e)
      EXPECT_EQ(used.contains(e), solid(c, edge(e).low) != solid(c, edge(e).high)) << c << ' ' << e;
  }
}

TEST(Cases, RimsLieInFacesAndDiagonalsDoNot) {
  for (int c = 0; c < 256; ++c) {
    const CellCase& cell = case_table()[c];
    const std::set<Segment> border = rim(cell);
    for (unsigned t = 0; t < cell.triangles; ++t)
      for (unsigned k = 0; k < 3; ++k) {
        const int a = cell.edges[3 * t + k], b = cell.edges[3 * t + (k + 1) % 3];
        EXPECT_EQ(border.contains({a, b}), common_face(a, b) >= 0) << c;
      }
  }
}

TEST(Cases, AdjacentCellsAgreeOnEveryPairOfCases) {
  // For each face and each pattern of its four corners, all cases with that pattern leave the same segments.
  for (int axis = 0; axis < 3; ++axis) {
    std::map<int, std::set<Segment>> by_pattern[2];
    for (int c = 0; c < 256; ++c)
      for (int side = 0; side < 2; ++side) {
        int pattern = 0;
        for (int corner = 0, bit = 0; corner < 8; ++corner)
          if (((corner >> axis) & 1) == side) pattern |= solid(c, corner) << bit++;
        std::set<Segment> segments;
        for (auto [a, b] : rim(case_table()[c])) {
          if (common_face(a, b) != 2 * axis + side) continue;
          // Named as the cell on the low side of the face names them; it runs the other way around there.
          const auto moved = [&](int e) {
            const Edge from = edge(e);
            for (int f = 0; f < 12; ++f)
              if (edge(f).low == (from.low & ~(1 << axis)) && edge(f).high == (from.high & ~(1 << axis)))
                return f;
            return -1;
          };
          segments.insert(side == 0 ? Segment{moved(a), moved(b)} : Segment{moved(b), moved(a)});
        }
        const auto [at, fresh] = by_pattern[side].emplace(pattern, segments);
        EXPECT_EQ(at->second, segments) << "axis " << axis << " case " << c;
      }
    EXPECT_EQ(by_pattern[0], by_pattern[1]);
  }
}

TEST(Cases, TrianglesFaceAwayFromTheSolid) {
  for (int corner = 0; corner < 8; ++corner) {
    const CellCase& cell = case_table()[1 << corner];
    ASSERT_EQ(cell.triangles, 1);
    double p[3][3];
    for (std::size_t v = 0; v < 3; ++v)
      for (int axis = 0; axis < 3; ++axis)
        p[v][axis] =
            (((edge(cell.edges[v]).low >> axis) & 1) + ((edge(cell.edges[v]).high >> axis) & 1)) / 2.0;
    double u[3], w[3], out[3];
    for (int axis = 0; axis < 3; ++axis) {
      u[axis] = p[1][axis] - p[0][axis];
      w[axis] = p[2][axis] - p[0][axis];
      out[axis] = 0.5 - ((corner >> axis) & 1);
    }
    const double facing = out[0] * (u[1] * w[2] - u[2] * w[1]) + out[1] * (u[2] * w[0] - u[0] * w[2]) +
                          out[2] * (u[0] * w[1] - u[1] * w[0]);
    EXPECT_GT(facing, 0);
  }
}

/// In 128ths of a cell, so that determinants are exact.
using Place = std::array<std::int64_t, 3>;

/// The sign says on which side of a, b and c lies d.
std::int64_t side_of(const Place& a, const Place& b, const Place& c, const Place& d) {
  std::int64_t u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) u[i] = a[i] - d[i], v[i] = b[i] - d[i], w[i] = c[i] - d[i];
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/// Whether an edge of the first triangle goes through the inside of the second.
bool pierces(const std::array<Place, 3>& a, const std::array<Place, 3>& b) {
  for (int i = 0; i < 3; ++i) {
    const Place &p = a[i], &q = a[(i + 1) % 3];
    const std::int64_t from = side_of(b[0], b[1], b[2], p), to = side_of(b[0], b[1], b[2], q);
    if (from == 0 || to == 0 || (from > 0) == (to > 0)) continue;
    int left = 0, right = 0;
    for (int k = 0; k < 3; ++k) {
      const std::int64_t side = side_of(p, q, b[k], b[(k + 1) % 3]);
      left += side > 0, right += side < 0;
    }
    if (left == 3 || right == 3) return true;
  }
  return false;
}

TEST(Cases, TrianglesDoNotCross) {
  // Those of different cells cannot: a vertex stays within its edge.
  EXPECT_TRUE(pierces({{{0, 0, -1}, {0, 0, 1}, {9, 9, 9}}}, {{{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}}}));
  EXPECT_FALSE(pierces({{{6, 0, -1}, {6, 0, 1}, {9, 9, 9}}}, {{{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}}}));
  Random random(8);
  for (int c = 0; c < 256; ++c) {
    const CellCase& cell = case_table()[c];
    for (int draw = 0; draw < 300; ++draw) {
      std::array<Place, 12> at{};
      for (int e = 0; e < 12; ++e) {
        for (int axis = 0; axis < 3; ++axis) at[e][axis] = 128 * ((edge(e).low >> axis) & 1);
        const auto anywhere = static_cast<std::int64_t>(1 + random.below(127));
        at[e][e / 4] = draw % 2 == 0 ? anywhere : random.below(2) ? 1 : 127;
      }
      const auto triangle = [&](unsigned t) {
        return std::array{at[cell.edges[3 * t]], at[cell.edges[3 * t + 1]], at[cell.edges[3 * t + 2]]};
      };
      for (unsigned t = 0; t < cell.triangles; ++t)
        for (unsigned other = 0; other < cell.triangles; ++other)
          ASSERT_FALSE(pierces(triangle(t), triangle(other))) << c << ' ' << t << ' ' << other;
    }
  }
}

TEST(Cases, SeparateTheSolidCornersOfAnAmbiguousFace) {
  // Two solid corners across a face: two triangles that share nothing.
  const CellCase& cell = case_table()[0b1001];
  EXPECT_EQ(cell.triangles, 2);
  EXPECT_EQ(std::set<int>(cell.edges.begin(), cell.edges.begin() + 6).size(), 6u);
}

}  // namespace
}  // namespace tafoni::surface::impl
