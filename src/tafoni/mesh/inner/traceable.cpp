#include "tafoni/mesh/inner/traceable.h"

#include <cmath>

#include "tafoni/core/error.h"

namespace tafoni::mesh::inner {

void check_traceable(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size();
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v >= count) fail(ErrorKind::input, "a triangle names vertex {} of {}", v, count);
  for (const Vec3f& p : mesh.positions) {
    for (const float d : {p.x, p.y, p.z}) {
      if (std::abs(d) <= farthest_vertex) continue;
      if (!std::isfinite(d)) fail(ErrorKind::input, "a vertex of the mesh is not finite");
      fail(ErrorKind::input,
           "a vertex of the mesh lies {:g} m from its origin, and {:g} m is the farthest that can be worked "
           "with: check its coordinates and units",
           std::abs(d), farthest_vertex);
    }
  }
  for (const std::size_t given : {mesh.normals.size(), mesh.colors.size()})
    if (given != 0 && given != count)
      fail(ErrorKind::input, "a mesh of {} vertices has normals or colours for {}", count, given);
}

}  // namespace tafoni::mesh::inner
