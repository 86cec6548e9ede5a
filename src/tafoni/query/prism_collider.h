#pragma once
// Collisions with prism-fields.

#include <memory>
#include <vector>

#include "tafoni/query/collider.h"
#include "tafoni/surface/prism_mesher.h"
#include "tafoni/volume/prism_field.h"

namespace tafoni::query {

/// Meets the triangles of surface::PrismMesher, at their local positions rounded to float. Holds its own
/// snapshot of the columns and their mesh; the index over a chunk's triangles is made when a query first
/// comes near.
class PrismCollider : public Collider {
 public:
  explicit PrismCollider(const volume::PrismFields& fields, const surface::PrismMeshSettings& settings = {});
  ~PrismCollider() override;

  /// From now on the ground is `now`, of the same frame, which differs in the columns `changed` only: their
  /// chunks are meshed anew. No query may be under way.
  void update(const volume::PrismFields& now, const volume::ColumnBox& changed);

  Box3d bounds() const override { return bounds_; }

 protected:
  void visit(const Box3d& box, const TreeVisitor& visitor) const override;
  Side side(Vec3d p) const override;
  double reach() const override { return std::numeric_limits<double>::infinity(); }
  double stride() const override;
  bool empty(const Box3d& box) const override { return !box.overlaps(bounds_); }

 private:
  struct Chunk;
  std::ptrdiff_t index(int a, int b) const { return std::ptrdiff_t{b} * mesher_.chunks_x() + a; }
  const impl::TriangleTree& tree(int a, int b) const;

  volume::PrismFields fields_;
  surface::PrismMesher mesher_;
  Box3d bounds_;
  std::vector<std::unique_ptr<Chunk>> chunks_;  ///< a fastest
};

}  // namespace tafoni::query
