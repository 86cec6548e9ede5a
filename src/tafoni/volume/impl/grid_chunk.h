#pragma once
// One chunk of a scalar grid, shared between copies of the grid until one of them is edited.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "tafoni/math/half.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume::impl {

inline constexpr int side = ScalarGrid::chunk_samples;
inline constexpr int chunk_size = side * side * side;
/// Blocks of 8^3 samples, whose least and greatest values are kept: a side, and in a chunk.
inline constexpr int block_side = 8, blocks_side = side / block_side,
                     blocks = blocks_side * blocks_side * blocks_side;

/// Samples beyond the grid's frame hold anything and count in no range.
struct GridChunk {
  std::atomic<std::uint32_t> owners{1};
  std::unique_ptr<float[]> single;
  std::unique_ptr<std::uint16_t[]> half;  ///< one of the two
  Interval range;
  std::array<Interval, blocks> ranges;

  static int index(int x, int y, int z) { return (z * side + y) * side + x; }
  float at(int i) const { return single ? single[i] : from_half(half[i]); }
};

/// A shared chunk or none. Counts owners itself since std::shared_ptr::use_count() does not synchronise.
class ChunkPtr {
 public:
  ChunkPtr() = default;
  explicit ChunkPtr(GridChunk* chunk) : chunk_(chunk) {}
  ChunkPtr(const ChunkPtr& other) : chunk_(other.chunk_) {
    if (chunk_) chunk_->owners.fetch_add(1, std::memory_order_relaxed);
  }
  ChunkPtr(ChunkPtr&& other) noexcept : chunk_(std::exchange(other.chunk_, nullptr)) {}
  ChunkPtr& operator=(ChunkPtr other) noexcept {
    std::swap(chunk_, other.chunk_);
    return *this;
  }
  ~ChunkPtr() {
    if (chunk_ && chunk_->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete chunk_;
  }
  const GridChunk* get() const { return chunk_; }
  explicit operator bool() const { return chunk_ != nullptr; }
  bool sole() const { return chunk_->owners.load(std::memory_order_acquire) == 1; }
  /// Only the sole owner may ask for it.
  GridChunk& mine() { return *chunk_; }

 private:
  GridChunk* chunk_ = nullptr;
};

/// A chunk with all its samples, or the one value that they all have.
struct Slot {
  ChunkPtr chunk;
  float value = 0;
};

/// Makes the slot's chunk a full one that no other grid shares.
GridChunk& own(Slot& slot, Precision precision);
/// A chunk of these samples, the ones beyond `extent` not written yet.
std::unique_ptr<GridChunk> make_chunk(std::unique_ptr<float[]> samples, Precision precision, Vec3i extent);
/// Takes the ranges of the blocks whose bit is set anew, from the samples below `extent`, then the chunk's.
void update_ranges(GridChunk& chunk, std::uint64_t touched, Vec3i extent);

}  // namespace tafoni::volume::impl
