#include "tafoni/mesh/texture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"

namespace tafoni::mesh {
namespace {

/// Triangles of random places and sizes that face every way.
Mesh scraps() {
  Mesh mesh;
  Random random(3);
  for (std::uint32_t i = 0; i < 600; i += 3) {
    for (int c = 0; c < 3; ++c)
      mesh.positions.push_back(
          to_float({random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)}));
    mesh.triangles.push_back({i, i + 1, i + 2});
  }
  return mesh;
}

TEST(Texture, IsNeverMirroredNorStretchedBeyondTheSlant) {
  Mesh mesh = scraps();
  constexpr double size = 4;
  box_texture(mesh, size);
  ASSERT_EQ(mesh.texture.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const Vec3d a = to_double(mesh.positions[v[0]]);
    const Vec3d n = cross(to_double(mesh.positions[v[1]]) - a, to_double(mesh.positions[v[2]]) - a);
    const auto& uv = mesh.texture[t];
    const double area = (static_cast<double>(uv[1].x - uv[0].x) * static_cast<double>(uv[2].y - uv[0].y) -
                         static_cast<double>(uv[1].y - uv[0].y) * static_cast<double>(uv[2].x - uv[0].x)) *
                        size * size;
    // The picture's share of the triangle is the greatest of the three projections; seen from outside, the
    // corners run round the same way on both.
    EXPECT_NEAR(area, std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1e-3);
    EXPECT_GE(area, length(n) / std::sqrt(3) - 1e-3);
  }
}

TEST(Texture, NeedsALength) {
  Mesh mesh = scraps();
  EXPECT_THROW(box_texture(mesh, 0), Error);
  EXPECT_THROW(box_texture(mesh, NAN), Error);
}

}  // namespace
}  // namespace tafoni::mesh
