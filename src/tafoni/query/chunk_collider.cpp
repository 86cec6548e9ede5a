// Finds the chunks near a box and their trees, which are made when they are first asked for; tells sides by
// the eight samples of a cell.

#include "tafoni/query/chunk_collider.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tafoni/field/chunks.h"
#include "tafoni/query/impl/triangle_tree.h"

namespace tafoni::query {

namespace {

constexpr int chunk_cells = volume::ScalarGrid::chunk_samples;

}  // namespace

ChunkShape::ChunkShape(surface::GridChunkPtr mesh) : mesh_(std::move(mesh)) {}
ChunkShape::~ChunkShape() = default;

const impl::TriangleTree& ChunkShape::tree() const {
  std::call_once(once_, [this] {
    tree_ = std::make_unique<const impl::TriangleTree>(mesh_->positions, mesh_->triangles);
  });
  return *tree_;
}

ChunkCollider::ChunkCollider(const volume::ScalarGrid& grid, Find find)
    : grid_(grid), find_(std::move(find)) {}

Box3d ChunkCollider::bounds() const {
  return grid_.frame().box().grown(grid_.frame().spacing);
}

double ChunkCollider::reach() const {
  return 1.75 * grid_.frame().spacing;  // more than a cell's diagonal
}

double ChunkCollider::stride() const {
  return chunk_cells * grid_.frame().spacing;
}

/// The chunk whose triangles may touch p; what lies beyond the frame belongs to the nearest.
Vec3i ChunkCollider::chunk_of(Vec3d p) const {
  const volume::GridFrame& frame = grid_.frame();
  const Vec3i chunks = grid_.chunks();
  const auto axis = [&](double d, int n) {
    return static_cast<std::int32_t>(std::clamp(std::floor(d / stride()), 0.0, n - 1.0));
  };
  const Vec3d d = p - frame.origin;
  return {axis(d.x, chunks.x), axis(d.y, chunks.y), axis(d.z, chunks.z)};
}

void ChunkCollider::visit(const Box3d& box, const TreeVisitor& visitor) const {
  // Vertices are rounded to float and may lie that much outside of their chunk.
  const double most = std::max({std::abs(box.lo.x), std::abs(box.lo.y), std::abs(box.lo.z),
                                std::abs(box.hi.x), std::abs(box.hi.y), std::abs(box.hi.z)});
  const Box3d wider = box.grown(1.2e-7 * most);
  const Vec3i lo = chunk_of(wider.lo), hi = chunk_of(wider.hi);
  for (std::int32_t c = lo.z; c <= hi.z; ++c)
    for (std::int32_t b = lo.y; b <= hi.y; ++b)
      for (std::int32_t a = lo.x; a <= hi.x; ++a)
        if (const ChunkShape* shape = find_({a, b, c})) visitor(shape->tree());
}

Collider::Side ChunkCollider::side(Vec3d p) const {
  const volume::GridFrame& frame = grid_.frame();
  const Vec3d u = (p - frame.origin) * (1 / frame.spacing);
  const Vec3i n = frame.size;
  if (!(u.x >= -1 && u.y >= -1 && u.z >= -1 && u.x < n.x && u.y < n.y && u.z < n.z)) return Side::air;
  const Vec3i cell{static_cast<std::int32_t>(std::floor(u.x)), static_cast<std::int32_t>(std::floor(u.y)),
                   static_cast<std::int32_t>(std::floor(u.z))};
  int rock = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3i s{cell.x + (i & 1), cell.y + ((i >> 1) & 1), cell.z + (i >> 2)};
    const bool within = s.x >= 0 && s.y >= 0 && s.z >= 0 && s.x < n.x && s.y < n.y && s.z < n.z;
    rock += within && grid_.at(s) > 0;
  }
  return rock == 0 ? Side::air : rock == 8 ? Side::rock : Side::unknown;
}

bool ChunkCollider::empty(const Box3d& box) const {
  const double spacing = grid_.frame().spacing;
  const Interval range = grid_.range(box.grown(spacing));
  if (range.hi <= 0) return true;
  const Box3d frame = grid_.frame().box();
  return range.lo > 0 && frame.contains(box.lo - Vec3d{spacing, spacing, spacing}) &&
         frame.contains(box.hi + Vec3d{spacing, spacing, spacing});
}

}  // namespace tafoni::query
