#include "tafoni/mesh/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"

namespace tafoni::mesh {
namespace {

/// The way from one coordinate to another.
double from(float a, float b) {
  return b - a;
}

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
    const double area =
        (from(uv[0].x, uv[1].x) * from(uv[0].y, uv[2].y) - from(uv[0].y, uv[1].y) * from(uv[0].x, uv[2].x)) *
        size * size;
    // The picture's share of the triangle is the greatest of the three projections; seen from outside, the
    // corners run round the same way on both.
    EXPECT_NEAR(area, std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1e-3);
    EXPECT_GE(area, length(n) / std::sqrt(3) - 1e-3);
  }
}

/// A sphere of 10 m with bumps of 2 cm, whose triangles face this way and that.
Mesh rough_sphere() {
  Mesh mesh;
  Random random(4);
  constexpr std::uint32_t rings = 90, around = 150;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double a = 3.141592653589793 * i / rings, b = 6.283185307179586 * j / around;
      const Vec3d out{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)};
      mesh.positions.push_back(to_float(out * (10 + 0.02 * random.uniform(-1, 1))));
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      if (i > 0) mesh.triangles.push_back({a, a + around, b});
      if (i + 1 < rings) mesh.triangles.push_back({b, a + around, b + around});
    }
  return mesh;
}

TEST(Texture, HasFewSeamsAndLittleStretch) {
  Mesh mesh = rough_sphere();
  box_texture(mesh, 1);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<Vec2<float>, 2>> met;
  std::size_t seams = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
      const Vec2<float> at_a = mesh.texture[t][c], at_b = mesh.texture[t][(c + 1) % 3];
      const auto [other, fresh] = met.try_emplace(std::minmax(a, b), std::array{at_a, at_b});
      seams += !fresh && (other->second[0] != at_b || other->second[1] != at_a);
    }
  // Twelve borders of 25 to 40 edges, ragged by the bumps; more where each triangle decides for itself.
  EXPECT_LT(seams, 12 * 60 * 2u);
  EXPECT_GT(seams, 12 * 20u);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const Vec3d a = to_double(mesh.positions[v[0]]);
    const double whole =
        length(cross(to_double(mesh.positions[v[1]]) - a, to_double(mesh.positions[v[2]]) - a));
    const auto& uv = mesh.texture[t];
    const double area =
        from(uv[0].x, uv[1].x) * from(uv[0].y, uv[2].y) - from(uv[0].y, uv[1].y) * from(uv[0].x, uv[2].x);
    ASSERT_GE(area, (least_facing - 0.01) * whole);
  }
}

TEST(Texture, NeedsALength) {
  Mesh mesh = scraps();
  EXPECT_THAT(error_of([&] { box_texture(mesh, 0); }), ::testing::HasSubstr("a length in metres, not 0"));
  EXPECT_THAT(error_of([&] { box_texture(mesh, NAN); }), ::testing::HasSubstr("a length in metres, not nan"));
}

}  // namespace
}  // namespace tafoni::mesh
