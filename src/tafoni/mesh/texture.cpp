// Chooses for each triangle the side of a box that its surroundings face most (the normals of its neighbours,
// averaged in a few rounds, so that one side covers a whole wall) and projects its corners from there.

#include "tafoni/mesh/texture.h"

#include <cmath>

#include "tafoni/core/error.h"

namespace tafoni::mesh {
namespace {

/// How often normals are summed over the triangles around: far enough that no small bump changes sides alone.
constexpr int rounds = 3;

/// Vectors across each triangle, as long as twice its area.
std::vector<Vec3f> faces(const Mesh& mesh) {
  std::vector<Vec3f> out;
  out.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]];
    out.push_back(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
  }
  return out;
}

/// Sums over the triangles around each triangle's vertices.
std::vector<Vec3f> sum_around(const Mesh& mesh, const std::vector<Vec3f>& normals) {
  std::vector<Vec3f> around(mesh.positions.size()), out;
  for (std::size_t t = 0; t < normals.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) around[v] += normals[t];
  out.reserve(normals.size());
  for (const auto& t : mesh.triangles) out.push_back(around[t[0]] + around[t[1]] + around[t[2]]);
  return out;
}

/// Twice the axis, and one more where the vector goes down it.
int side_of(Vec3f n) {
  const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (z >= x && z >= y) return n.z >= 0 ? 4 : 5;
  if (x >= y) return n.x >= 0 ? 0 : 1;
  return n.y >= 0 ? 2 : 3;
}

/// How squarely a triangle faces a side: 1 at most.
float facing(Vec3f n, int side) {
  const float along = side / 2 == 0 ? n.x : side / 2 == 1 ? n.y : n.z, size = length(n);
  return size > 0 ? (side % 2 ? -along : along) / size : 0;
}

/// Seen from outside, u goes right; v goes up, or north.
Vec2<float> project(Vec3f p, int side) {
  switch (side) {
    case 0:
      return {p.y, p.z};
    case 1:
      return {-p.y, p.z};
    case 2:
      return {-p.x, p.z};
    case 3:
      return {p.x, p.z};
    case 4:
      return {p.x, p.y};
    default:
      return {-p.x, p.y};
  }
}

}  // namespace

void box_texture(Mesh& mesh, double size) {
  if (!(size > 0) || !std::isfinite(size))
    fail(ErrorKind::usage, "the size of a texture must be a length in metres, not {}", size);
  const auto scale = static_cast<float>(1 / size);
  const std::vector<Vec3f> own = faces(mesh);
  std::vector<Vec3f> around = own;
  for (int i = 0; i < rounds; ++i) around = sum_around(mesh, around);
  mesh.texture.clear();
  mesh.texture.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < own.size(); ++t) {
    int side = side_of(around[t]);
    if (facing(own[t], side) < least_facing) side = side_of(own[t]);
    std::array<Vec2<float>, 3> corners;
    for (std::size_t c = 0; c < 3; ++c)
      corners[c] = project(mesh.positions[mesh.triangles[t][c]] * scale, side);
    mesh.texture.push_back(corners);
  }
}

}  // namespace tafoni::mesh
