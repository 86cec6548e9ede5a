#pragma once
// Collisions with a compiled field.

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "tafoni/field/compiled.h"
#include "tafoni/query/lattice_collider.h"

namespace tafoni::query {

struct FieldSettings {
  double voxel = 1;   ///< metres; that of the mesh which the collider shall agree with
  Box3d region = {};  ///< what that is a mesh of, if not of the field's bounds
  std::size_t cache_bytes = std::size_t{256} << 20;
};

/// Meets the triangles of surface::polygonize() on the same lattice, bit for bit; small floating pieces that
/// the mesh leaves out are met. A cube of 16^3 cells is evaluated when a query first comes near.
class FieldCollider : public LatticeCollider {
 public:
  /// Throws Error{usage} for a voxel that is too small for the region.
  FieldCollider(field::CompiledField field, const FieldSettings& settings);
  ~FieldCollider() override;

  /// From now on the field is `now`, which differs from the last one in the boxes only (local metres). No
  /// query may be under way.
  void update(field::CompiledField now, std::span<const Box3d> changed);

  Box3d bounds() const override { return bounds_; }

 protected:
  TilePtr make(Vec3i tile) const override;
  bool empty(const Box3d& box) const override;

 private:
  struct Worker;
  std::unique_ptr<Worker> take(Vec3i chunk) const;

  field::CompiledField field_;
  FieldSettings settings_;
  Box3d bounds_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Worker>> idle_;
};

}  // namespace tafoni::query
