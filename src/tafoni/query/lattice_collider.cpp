// Looks up the tiles that a box touches in the cache and shows their trees; tells sides by the signs of a
// cell's corners.

#include "tafoni/query/lattice_collider.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/query/impl/tile.h"

namespace tafoni::query {

using impl::Tile;

LatticeCollider::LatticeCollider(Vec3d origin, double voxel, std::size_t cache_bytes)
    : origin_(origin), voxel_(voxel), cache_(std::make_unique<impl::TileCache>(cache_bytes)) {
  if (!(voxel > 0) || !std::isfinite(voxel))
    fail(ErrorKind::usage, "a voxel of {} m cannot be used: give a size above 0", voxel);
}
LatticeCollider::~LatticeCollider() = default;

LatticeCollider::CacheStats LatticeCollider::cache() const {
  const impl::TileCache::Stats s = cache_->stats();
  return {s.tiles, s.bytes, s.made};
}

double LatticeCollider::reach() const {
  return 1.75 * voxel_;  // more than a cell's diagonal
}

double LatticeCollider::stride() const {
  return Tile::cells * voxel_;
}

Vec3i LatticeCollider::tile_of(Vec3d p) const {
  const auto axis = [&](double d) {
    return static_cast<std::int32_t>(std::floor(d / (voxel_ * Tile::cells)));
  };
  return {axis(p.x - origin_.x), axis(p.y - origin_.y), axis(p.z - origin_.z)};
}

LatticeCollider::TilePtr LatticeCollider::tile(Vec3i index) const {
  return cache_->get(index, [this](Vec3i i) { return make(i); });
}

void LatticeCollider::visit(const Box3d& box, const TreeVisitor& visitor) const {
  // Vertices are rounded to float and may lie that much outside of their tile.
  const double most = std::max({std::abs(box.lo.x), std::abs(box.lo.y), std::abs(box.lo.z),
                                std::abs(box.hi.x), std::abs(box.hi.y), std::abs(box.hi.z)});
  const Box3d wider = box.grown(1.2e-7 * most);
  const Vec3i lo = tile_of(wider.lo), hi = tile_of(wider.hi);
  for (std::int32_t c = lo.z; c <= hi.z; ++c)
    for (std::int32_t b = lo.y; b <= hi.y; ++b)
      for (std::int32_t a = lo.x; a <= hi.x; ++a) {
        const TilePtr found = tile({a, b, c});
        if (!found->triangles.empty()) visitor(found->triangles);
      }
}

Collider::Side LatticeCollider::side(Vec3d p) const {
  const auto cell = [&](double d) { return std::floor(d / voxel_); };
  const Vec3d at{cell(p.x - origin_.x), cell(p.y - origin_.y), cell(p.z - origin_.z)};
  constexpr double most = 1 << 30;
  if (!(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) < most)) return Side::air;
  const Vec3i i{static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y),
                static_cast<std::int32_t>(at.z)};
  constexpr int shift = 4, mask = Tile::cells - 1;
  static_assert(1 << shift == Tile::cells);
  const TilePtr found = tile({i.x >> shift, i.y >> shift, i.z >> shift});
  const int corners = found->solid_corners(i.x & mask, i.y & mask, i.z & mask);
  return corners == 0 ? Side::air : corners == 8 ? Side::rock : Side::unknown;
}

void LatticeCollider::forget(std::span<const Box3d> changed) {
  for (const Box3d& box : changed)
    if (!box.empty()) cache_->drop(tile_of(box.grown(voxel_).lo), tile_of(box.grown(voxel_).hi));
}

}  // namespace tafoni::query
