#include "tafoni/query/mesh_collider.h"

#include "tafoni/mesh/inner/traceable.h"
#include "tafoni/query/impl/triangle_tree.h"

namespace tafoni::query {

MeshCollider::MeshCollider(const mesh::Mesh& mesh) {
  mesh::inner::check_traceable(mesh);
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
