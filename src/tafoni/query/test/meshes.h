#pragma once
// Meshes whose distances are known.

#include <cmath>
#include <map>
#include <utility>

#include "tafoni/core/random.h"
#include "tafoni/mesh/inner/size32.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::query::testing {

/// Corners of a box, outward.
inline mesh::Mesh box_mesh(Vec3d lo, Vec3d hi) {
  mesh::Mesh m;
  for (int i = 0; i < 8; ++i)
    m.positions.push_back(to_float({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z}));
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

/// An octahedron refined `levels` times, its corners on the sphere.
inline mesh::Mesh sphere_mesh(Vec3d center, double radius, int levels) {
  std::vector<Vec3d> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int l = 0; l < levels; ++l) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, fresh] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, mesh::inner::size32(points));
      if (fresh) points.push_back(normalized(points[a] + points[b]));
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  mesh::Mesh m;
  for (const Vec3d& p : points) m.positions.push_back(to_float(center + p * radius));
  m.triangles = std::move(triangles);
  return m;
}

inline void append(mesh::Mesh& to, const mesh::Mesh& from) {
  const auto first = mesh::inner::size32(to.positions);
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  for (const auto& t : from.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

inline Vec3d random_point(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// Triangles of all sizes, long and thin ones too; they do not enclose anything.
inline mesh::Mesh soup(int count, double size, std::uint64_t seed) {
  mesh::Mesh m;
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3d at = random_point(random, size);
    const double extent = std::exp(random.uniform(-4, 1));
    const auto first = mesh::inner::size32(m.positions);
    for (int c = 0; c < 3; ++c) m.positions.push_back(to_float(at + random_point(random, extent)));
    m.triangles.push_back({first, first + 1, first + 2});
  }
  return m;
}

}  // namespace tafoni::query::testing
