#pragma once
// What colliders of sampled surfaces share: cubes of 16^3 cells whose triangles are made when a query first
// comes near, and kept in a cache of limited size.

#include <cstdint>
#include <memory>
#include <span>

#include "tafoni/query/collider.h"

namespace tafoni::query {

namespace impl {
struct Tile;
class TileCache;
}  // namespace impl

class LatticeCollider : public Collider {
 public:
  ~LatticeCollider() override;

  struct CacheStats {
    std::uint64_t tiles = 0, bytes = 0;
    std::uint64_t made = 0;  ///< since the collider was
  };
  CacheStats cache() const;

 protected:
  using TilePtr = std::shared_ptr<const impl::Tile>;

  /// Sample (i, j, k) of the lattice lies at origin + voxel * (i, j, k).
  LatticeCollider(Vec3d origin, double voxel, std::size_t cache_bytes);
  /// The tile of the cells from (16 a, 16 b, 16 c).
  virtual TilePtr make(Vec3i tile) const = 0;

  void visit(const Box3d& box, const TreeVisitor& visitor) const override;
  Side side(Vec3d p) const override;
  double reach() const override;
  double stride() const override;

  /// Gives up every tile that samples in one of the boxes have a part in. No query may be under way.
  void forget(std::span<const Box3d> changed);
  double voxel() const { return voxel_; }

 private:
  Vec3i tile_of(Vec3d p) const;
  TilePtr tile(Vec3i index) const;

  Vec3d origin_;
  double voxel_;
  std::unique_ptr<impl::TileCache> cache_;
};

}  // namespace tafoni::query
