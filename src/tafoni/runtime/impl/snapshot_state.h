#pragma once
// What a snapshot holds.

#include "tafoni/query/chunk_collider.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/runtime/impl/chunk_table.h"

namespace tafoni::runtime {

struct Snapshot::State {
  std::uint64_t version;
  Vec3d origin;
  volume::ScalarGrid grid;
  impl::ChunkTable chunks;
  query::ChunkCollider collider;

  State(std::uint64_t v, Vec3d o, const volume::ScalarGrid& g, const impl::ChunkTable& c)
      : version(v),
        origin(o),
        grid(g),
        chunks(c),
        collider(grid, [this](Vec3i chunk) -> const query::ChunkShape* {
          const impl::ChunkEntry* entry = chunks.find(chunk);
          return entry && !entry->shape->mesh()->triangles.empty() ? entry->shape.get() : nullptr;
        }) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

}  // namespace tafoni::runtime
