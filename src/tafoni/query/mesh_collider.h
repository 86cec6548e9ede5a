#pragma once
// Collisions with a mesh.

#include <memory>

#include "tafoni/mesh/mesh.h"
#include "tafoni/query/collider.h"

namespace tafoni::query {

/// Positions are relative to the mesh's origin. A point is in the rock when it lies behind the surface
/// nearest to it, which of a closed mesh is its inside; near the border of an open one it means little.
class MeshCollider : public Collider {
 public:
  /// Holds about 45 bytes a triangle. Throws Error{input} for indices out of range and positions that are not
  /// finite or farther than 1e9 m from the origin.
  explicit MeshCollider(const mesh::Mesh& mesh);
  ~MeshCollider() override;

  Box3d bounds() const override;

 protected:
  void visit(const Box3d& box, const TreeVisitor& visitor) const override;
  Side side(Vec3d p) const override;
  double reach() const override { return std::numeric_limits<double>::infinity(); }
  double stride() const override { return std::numeric_limits<double>::infinity(); }
  bool empty(const Box3d& box) const override;

 private:
  std::unique_ptr<const impl::TriangleTree> tree_;
};

}  // namespace tafoni::query
