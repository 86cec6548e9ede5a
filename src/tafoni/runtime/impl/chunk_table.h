#pragma once
// Where a version's chunks are found: copies share all but the blocks in which they differ.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "tafoni/math/vec.h"
#include "tafoni/query/chunk_collider.h"

namespace tafoni::runtime::impl {

struct ChunkEntry {
  std::unique_ptr<const query::ChunkShape> shape;
  std::uint64_t version = 0;
};
using ChunkEntryPtr = std::shared_ptr<const ChunkEntry>;

class ChunkTable {
 public:
  explicit ChunkTable(Vec3i chunks) : chunks_(chunks) {
    const auto blocks = [](int n) { return (n + side - 1) / side; };
    blocks_ = {blocks(chunks.x), blocks(chunks.y), blocks(chunks.z)};
    table_.resize(std::ptrdiff_t{blocks_.x} * blocks_.y * blocks_.z);
  }

  /// Null where there is no surface, and beyond the grid.
  const ChunkEntry* find(Vec3i c) const {
    if (c.x < 0 || c.y < 0 || c.z < 0 || c.x >= chunks_.x || c.y >= chunks_.y || c.z >= chunks_.z)
      return nullptr;
    const Block* block = table_[block_of(c)].get();
    return block ? (*block)[place_of(c)].get() : nullptr;
  }
  void set(Vec3i c, ChunkEntryPtr entry) {
    auto& block = table_[block_of(c)];
    auto own = block ? std::make_shared<Block>(*block) : std::make_shared<Block>();
    (*own)[place_of(c)] = std::move(entry);
    block = std::move(own);
  }
  /// visit(chunk, entry), sorted by y, x, z.
  template <class Visit>
  void each(const Visit& visit) const {
    for (int y = 0; y < chunks_.y; ++y)
      for (int x = 0; x < chunks_.x; ++x)
        for (int z = 0; z < chunks_.z; ++z)
          if (const ChunkEntry* entry = find({x, y, z})) visit(Vec3i{x, y, z}, *entry);
  }

 private:
  static constexpr int side = 4;
  using Block = std::array<ChunkEntryPtr, side * side * side>;

  std::ptrdiff_t block_of(Vec3i c) const {
    return (std::ptrdiff_t{c.z / side} * blocks_.y + c.y / side) * blocks_.x + c.x / side;
  }
  static int place_of(Vec3i c) { return (c.z % side * side + c.y % side) * side + c.x % side; }

  Vec3i chunks_, blocks_;
  std::vector<std::shared_ptr<const Block>> table_;
};

}  // namespace tafoni::runtime::impl
