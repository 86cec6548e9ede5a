#include "tafoni/mesh/texture.h"

#include <cmath>

#include "tafoni/core/error.h"

namespace tafoni::mesh {

void box_texture(Mesh& mesh, double size) {
  if (!(size > 0) || !std::isfinite(size))
    fail(ErrorKind::usage, "the size of a texture must be a length in metres, not {}", size);
  const auto scale = static_cast<float>(1 / size);
  mesh.texture.clear();
  mesh.texture.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]];
    const Vec3f n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    std::array<Vec2<float>, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f p = mesh.positions[t[c]] * scale;
      // Seen from outside, u goes right; v goes up, or north.
      corners[c] = z >= x && z >= y ? Vec2<float>{n.z >= 0 ? p.x : -p.x, p.y}
                   : x >= y         ? Vec2<float>{n.x >= 0 ? p.y : -p.y, p.z}
                                    : Vec2<float>{n.y >= 0 ? -p.x : p.x, p.z};
    }
    mesh.texture.push_back(corners);
  }
}

}  // namespace tafoni::mesh
