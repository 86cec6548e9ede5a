#include "tafoni/query/mesh_collider.h"

#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/query/impl/triangle_tree.h"

namespace tafoni::query {

MeshCollider::MeshCollider(const mesh::Mesh& mesh) {
  for (const auto& t : mesh.triangles)
    for (std::uint32_t v : t)
      if (v >= mesh.positions.size())
        fail(ErrorKind::input, "a triangle names vertex {} of {}", v, mesh.positions.size());
  for (const Vec3f& p : mesh.positions)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      fail(ErrorKind::input, "a vertex of the mesh is not finite");
  tree_ = std::make_unique<impl::TriangleTree>(mesh.positions, mesh.triangles);
}
MeshCollider::~MeshCollider() = default;

Box3d MeshCollider::bounds() const {
  if (tree_->empty()) return {};
  return {to_double(tree_->bounds().lo), to_double(tree_->bounds().hi)};
}

void MeshCollider::visit(const Box3d& box, const TreeVisitor& visitor) const {
  if (box.overlaps(bounds())) visitor(*tree_);
}

Collider::Side MeshCollider::side(Vec3d) const {
  return tree_->empty() ? Side::air : Side::unknown;
}

bool MeshCollider::empty(const Box3d& box) const {
  return !box.overlaps(bounds());
}

}  // namespace tafoni::query
