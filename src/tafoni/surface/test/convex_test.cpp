#include "tafoni/surface/impl/convex.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/surface/impl/cases.h"

namespace tafoni::surface::impl {
namespace {

constexpr double tolerance = 1.0 / 256;

/// A cell's triangles, from its corners' values, edges numbered as cases.h has them.
struct Cell {
  int solid = 0;
  std::vector<std::uint32_t> triangles;
  std::array<Vec3f, 12> positions;
};

/// Where a corner of the unit cell lies.
Vec3d corner_at(int c) {
  return to_double(Vec3i{c & 1, (c >> 1) & 1, c >> 2});
}

Cell make_cell(const std::array<double, 8>& f) {
  Cell cell;
  for (int c = 0; c < 8; ++c) cell.solid |= (f[c] > 0) << c;
  for (int e = 0; e < 12; ++e) {
    const int axis = e / 4, low = e & 1, high = (e >> 1) & 1;
    const int from = axis == 0 ? 2 * low + 4 * high : axis == 1 ? low + 4 * high : low + 2 * high;
    const double a = f[from], b = f[from + (1 << axis)];
    const double t = std::clamp(a / (a - b), 1.0 / 128, 127.0 / 128);
    Vec3d p = corner_at(from);
    (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += t;
    cell.positions[e] = to_float(p);
  }
  const CellCase& c = case_table()[cell.solid];
  cell.triangles.assign(c.edges.begin(), c.edges.begin() + 3 * c.triangles);
  return cell;
}

/// The outline of some triangles that hang together.
std::vector<Vec3d> outline(const Cell& cell, const std::vector<std::size_t>& group) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> sides;
  for (std::size_t t : group)
    for (std::size_t i = 0; i < 3; ++i)
      sides[{cell.triangles[3 * t + i], cell.triangles[3 * t + (i + 1) % 3]}] = true;
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& [side, there] : sides)
    if (!sides.contains({side.second, side.first})) next[side.first] = side.second;
  std::vector<Vec3d> out;
  for (std::uint32_t at = next.begin()->first; out.size() < next.size(); at = next[at])
    out.push_back(to_double(cell.positions[at]));
  return out;
}

bool good(const std::vector<Vec3d>& p) {
  if (p.size() == 3) return true;
  Vec3d area, middle;
  for (std::size_t i = 0; i < p.size(); ++i) {
    area += cross(p[i], p[(i + 1) % p.size()]);
    middle += p[i] * (1.0 / static_cast<double>(p.size()));
  }
  const Vec3d normal = normalized(area);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (std::abs(dot(p[i] - middle, normal)) > tolerance) return false;
    const Vec3d a = p[i], b = p[(i + 1) % p.size()], c = p[(i + 2) % p.size()];
    if (dot(cross(b - a, c - b), normal) < 0) return false;
  }
  return true;
}

/// The fewest pieces over every way to join triangles that share a side.
std::size_t fewest(const Cell& cell) {
  const std::size_t n = cell.triangles.size() / 3;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) {
      int shared = 0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) shared += cell.triangles[3 * a + i] == cell.triangles[3 * b + j];
      if (shared == 2) pairs.emplace_back(a, b);
    }
  std::size_t best = n;
  for (unsigned choice = 0; choice < 1u << pairs.size(); ++choice) {
    std::vector<std::size_t> group(n);
    std::iota(group.begin(), group.end(), std::size_t{0});
    for (std::size_t p = 0; p < pairs.size(); ++p)
      if (choice >> p & 1) {
        const std::size_t from = group[pairs[p].second], to = group[pairs[p].first];
        std::replace(group.begin(), group.end(), from, to);
      }
    std::map<std::size_t, std::vector<std::size_t>> pieces;
    for (std::size_t t = 0; t < n; ++t) pieces[group[t]].push_back(t);
    bool all_good = true;
    for (const auto& [first, piece] : pieces) all_good = all_good && good(outline(cell, piece));
    if (all_good) best = std::min(best, pieces.size());
  }
  return best;
}

/// Planes with some noise, and noise alone.
std::array<double, 8> random_values(Random& random) {
  const double noise = std::pow(10, random.uniform(-5, 0.5));
  const Vec3d normal{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  const Vec3d through{random.uniform(), random.uniform(), random.uniform()};
  std::array<double, 8> f{};
  for (int c = 0; c < 8; ++c) {
    f[c] = dot(normal, corner_at(c) - through) + noise * random.uniform(-1, 1);
  }
  return f;
}

TEST(Convex, NoOtherUnionLeavesFewerPieces) {
  Random random(3);
  std::array<int, 6> by_count{};
  std::vector<bool> seen(256);
  for (int step = 0; step < 40000; ++step) {
    const Cell cell = make_cell(random_values(random));
    if (cell.triangles.empty()) continue;
    seen[cell.solid] = true;
    const int merge = best_merge(cell.solid, cell.triangles.data(), cell.positions.data(), tolerance);
    const ConvexPieces& pieces = convex_pieces(cell.solid, merge);
    ASSERT_EQ(pieces.count, fewest(cell)) << cell.solid;
    ++by_count[pieces.count];
    for (int p = 0; p < pieces.count; ++p) {
      std::vector<Vec3d> corners;
      for (int c = pieces.begin[p]; c < pieces.begin[p + 1]; ++c)
        corners.push_back(to_double(cell.positions[cell.triangles[pieces.corners[c]]]));
      ASSERT_TRUE(good(corners));
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 254);
  for (std::size_t n = 1; n < by_count.size(); ++n) EXPECT_GT(by_count[n], 0) << n;
}

}  // namespace
}  // namespace tafoni::surface::impl
