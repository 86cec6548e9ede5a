#pragma once
// Small meshes for the renderer's tests.

#include <cmath>

#include "tafoni/mesh/inner/size32.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::render {

/// Adds an axis-aligned box, facing out; `inward` turns it inside out, which makes a room.
inline void add_box(mesh::Mesh& mesh, Vec3f lo, Vec3f hi, bool inward = false) {
  const auto base = mesh::inner::size32(mesh.positions);
  for (unsigned i = 0; i < 8; ++i)
    mesh.positions.push_back({i & 1u ? hi.x : lo.x, i & 2u ? hi.y : lo.y, i & 4u ? hi.z : lo.z});
  static constexpr std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads)
    for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      std::array<std::uint32_t, 3> t{base + q[a], base + q[b], base + q[c]};
      if (inward) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
}

/// A box of separate faces with their own normals, so that shading is flat, and of one colour.
inline void add_flat_box(mesh::Mesh& mesh, Vec3f lo, Vec3f hi, std::array<std::uint8_t, 4> color,
                         bool inward = false) {
  mesh::Mesh box;
  add_box(box, lo, hi, inward);
  for (const auto& t : box.triangles) {
    const Vec3f a = box.positions[t[0]], b = box.positions[t[1]], c = box.positions[t[2]];
    const Vec3f n = normalized(cross(b - a, c - a));
    const auto base = mesh::inner::size32(mesh.positions);
    for (const Vec3f p : {a, b, c}) {
      mesh.positions.push_back(p);
      mesh.normals.push_back(n);
      mesh.colors.push_back(color);
    }
    mesh.triangles.push_back({base, base + 1, base + 2});
  }
}

/// A square terrain of n x n cells with one cliff that faces `cliff_azimuth` (radians clockwise from north).
inline mesh::Mesh terrain(int n, double cliff_azimuth) {
  mesh::Mesh mesh;
  mesh.origin = {500000, 4000000, 100};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = i - n / 2.0, y = j - n / 2.0;
      const double along = x * std::sin(cliff_azimuth) + y * std::cos(cliff_azimuth);
      const double z = 0.12 * n * (1 - std::tanh(along * 0.8)) + std::sin(x * 0.7) * std::sin(y * 0.5);
      mesh.positions.push_back(to_float({x, y, z}));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1;
      const std::uint32_t c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

}  // namespace tafoni::render
