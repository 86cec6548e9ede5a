#pragma once
// Collisions with the chunk meshes of a grid: nothing is polygonized twice, and an edit costs the colliders
// that come after it only the chunks that it changed.

#include <functional>
#include <memory>
#include <mutex>

#include "tafoni/query/collider.h"
#include "tafoni/surface/grid_mesher.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::query {

/// One chunk's mesh as colliders need it, to be shared by all of them. The index over its triangles, 45 bytes
/// each, is made when a query first comes near, by any thread.
class ChunkShape {
 public:
  explicit ChunkShape(surface::GridChunkPtr mesh);
  ~ChunkShape();
  const surface::GridChunkPtr& mesh() const { return mesh_; }
  const impl::TriangleTree& tree() const;

 private:
  surface::GridChunkPtr mesh_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<const impl::TriangleTree> tree_;
};

/// Meets the triangles of surface::GridMesher, bit for bit. Beyond the grid's frame all is air.
class ChunkCollider : public Collider {
 public:
  /// `find` gives a chunk's shape, null where it has no triangles; from any thread. It and the grid, whose
  /// mesh the shapes are, must outlive the collider.
  using Find = std::function<const ChunkShape*(Vec3i chunk)>;
  ChunkCollider(const volume::ScalarGrid& grid, Find find);

  Box3d bounds() const override;

 protected:
  void visit(const Box3d& box, const TreeVisitor& visitor) const override;
  Side side(Vec3d p) const override;
  double reach() const override;
  double stride() const override;
  bool empty(const Box3d& box) const override;

 private:
  Vec3i chunk_of(Vec3d p) const;

  const volume::ScalarGrid& grid_;
  Find find_;
};

}  // namespace tafoni::query
