#include "tafoni/query/grid_collider.h"

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"

namespace tafoni::query {

namespace impl {

GridChunks::GridChunks(const volume::ScalarGrid& grid) : grid_(grid) {}

std::size_t GridChunks::Hash::operator()(Vec3i v) const {
  const auto u = [](std::int32_t i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
  return mix64(u(v.x) | u(v.y) << 21 | u(v.z) << 42);
}

const ChunkShape* GridChunks::find(Vec3i chunk) const {
  const auto it = shapes_.find(chunk);
  return it == shapes_.end() ? nullptr : it->second.get();
}

void GridChunks::update(const volume::ScalarGrid& grid, std::span<const volume::SampleBox> changed,
                        Progress& progress) {
  if (!(grid.frame() == grid_.frame()))
    fail(ErrorKind::usage, "a collider keeps its grid's frame: make a new one for another frame");
  grid_ = grid;
  for (const surface::GridMesher::Change& change : mesher_.update(grid_, changed, progress)) {
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
