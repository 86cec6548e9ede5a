#include "tafoni/query/grid_collider.h"

#include "tafoni/core/error.h"

namespace tafoni::query {

namespace impl {

GridChunks::GridChunks(const volume::ScalarGrid& grid) : grid_(grid) {}

const ChunkShape* GridChunks::find(Vec3i chunk) const {
  const auto it = shapes_.find(chunk);
  return it == shapes_.end() ? nullptr : it->second.get();
}

void GridChunks::update(const volume::ScalarGrid& grid, std::span<const volume::SampleBox> changed,
                        Progress& progress) {
  if (!(grid.frame() == grid_.frame()))
    fail(ErrorKind::usage, "a collider keeps its grid's frame: make a new one for another frame");
  grid_ = grid;
  for (const surface::ChunkChange& change : mesher_.update(grid_, changed, progress)) {
    const surface::GridChunkPtr mesh = mesher_.chunk(change.chunk);
    if (mesh->triangles.empty())
      shapes_.erase(change.chunk);
    else
      shapes_[change.chunk] = std::make_unique<const ChunkShape>(mesh);
  }
}

}  // namespace impl

GridCollider::GridCollider(const volume::ScalarGrid& grid, Progress& progress)
    : GridChunks(grid), ChunkCollider(GridChunks::grid_, [this](Vec3i chunk) { return find(chunk); }) {
  GridChunks::update(grid, {}, progress);
}

void GridCollider::update(const volume::ScalarGrid& now, std::span<const volume::SampleBox> changed,
                          Progress& progress) {
  GridChunks::update(now, changed, progress);
}

}  // namespace tafoni::query
