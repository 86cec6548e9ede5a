#pragma once
// Collisions with a scalar grid.

#include <memory>
#include <span>
#include <unordered_map>

#include "tafoni/core/progress.h"
#include "tafoni/query/chunk_collider.h"
#include "tafoni/surface/grid_mesher.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::query {

namespace impl {

/// A grid as it was, and its chunks' meshes.
class GridChunks {
 protected:
  explicit GridChunks(const volume::ScalarGrid& grid);
  const ChunkShape* find(Vec3i chunk) const;
  void update(const volume::ScalarGrid& grid, std::span<const volume::SampleBox> changed, Progress& progress);

  volume::ScalarGrid grid_;
  surface::GridMesher mesher_{{surface::Boundary::solid, false}};
  std::unordered_map<Vec3i, std::unique_ptr<const ChunkShape>, surface::ChunkHash> shapes_;
};

}  // namespace impl

/// Meets the triangles of surface::GridMesher, bit for bit: a closed solid, beyond whose frame all is air.
/// Holds its own snapshot of the grid and its mesh; the index over a chunk's triangles is made when a query
/// first comes near.
class GridCollider : private impl::GridChunks, public ChunkCollider {
 public:
  explicit GridCollider(const volume::ScalarGrid& grid, Progress& progress = silent());

  /// From now on the grid is `now`, of the same frame, which differs in the boxes only: their chunks are
  /// meshed anew. No query may be under way.
  void update(const volume::ScalarGrid& now, std::span<const volume::SampleBox> changed,
              Progress& progress = silent());
};

}  // namespace tafoni::query
