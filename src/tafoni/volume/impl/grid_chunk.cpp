// What a chunk of a scalar grid does when it is made, shared and edited: it is copied once another grid
// holds it too, and each of its blocks keeps the least and the greatest of its values.

#include "tafoni/volume/impl/grid_chunk.h"

#include <algorithm>
#include <bit>

namespace tafoni::volume::impl {
namespace {

/// Over samples from `first` on, `size` a side.
Interval range_of(const GridChunk& chunk, Vec3i first, Vec3i size) {
  float row[block_side];
  float lo[block_side], hi[block_side];
  std::fill_n(lo, block_side, std::numeric_limits<float>::infinity());
  std::fill_n(hi, block_side, -std::numeric_limits<float>::infinity());
  for (int z = first.z; z < first.z + size.z; ++z)
    for (int y = first.y; y < first.y + size.y; ++y) {
      const int at = GridChunk::index(first.x, y, z);
      const float* samples = row;
      if (chunk.single)
        samples = chunk.single.get() + at;
      else
        from_half(chunk.half.get() + at, block_side, row);
      for (int i = 0; i < block_side; ++i) {
        lo[i] = samples[i] < lo[i] ? samples[i] : lo[i];
        hi[i] = samples[i] > hi[i] ? samples[i] : hi[i];
      }
    }
  return {*std::min_element(lo, lo + size.x), *std::max_element(hi, hi + size.x)};
}

}  // namespace

GridChunk& own(Slot& slot, Precision precision) {
  if (slot.chunk && slot.chunk.sole()) return slot.chunk.mine();
  auto made = std::make_unique<GridChunk>();
  const GridChunk* from = slot.chunk.get();
  if (precision == Precision::single) {
    made->single.reset(new float[chunk_size]);
    if (from)
      std::copy_n(from->single.get(), chunk_size, made->single.get());
    else
      std::fill_n(made->single.get(), chunk_size, slot.value);
  } else {
    made->half.reset(new std::uint16_t[chunk_size]);
    if (from)
      std::copy_n(from->half.get(), chunk_size, made->half.get());
    else
      std::fill_n(made->half.get(), chunk_size, to_half(slot.value));
  }
  if (from) {
    made->range = from->range;
    made->ranges = from->ranges;
  } else {
    made->range = {slot.value, slot.value};
    made->ranges.fill(made->range);
  }
  slot.chunk = ChunkPtr(made.release());
  return slot.chunk.mine();
}

std::unique_ptr<GridChunk> make_chunk(std::unique_ptr<float[]> samples, Precision precision, Vec3i extent) {
  // Beyond the frame, a value that is finite.
  if (extent.x < side || extent.y < side || extent.z < side)
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y) {
        const int used = z < extent.z && y < extent.y ? extent.x : 0;
        std::fill_n(samples.get() + GridChunk::index(used, y, z), side - used, 0.0f);
      }
  auto made = std::make_unique<GridChunk>();
  if (precision == Precision::single) {
    made->single = std::move(samples);
  } else {
    made->half.reset(new std::uint16_t[chunk_size]);
    to_half(samples.get(), chunk_size, made->half.get());
  }
  std::uint64_t used = 0;
  for (int b = 0; b < blocks; ++b)
    if (block_side * (b % blocks_side) < extent.x &&
        block_side * (b / blocks_side % blocks_side) < extent.y &&
        block_side * (b / (blocks_side * blocks_side)) < extent.z)
      used |= std::uint64_t{1} << b;
  update_ranges(*made, used, extent);
  return made;
}

void update_ranges(GridChunk& chunk, std::uint64_t touched, Vec3i extent) {
  for (std::uint64_t left = touched; left; left &= left - 1) {
    const int b = std::countr_zero(left);
    const Vec3i first{block_side * (b % blocks_side), block_side * (b / blocks_side % blocks_side),
                      block_side * (b / (blocks_side * blocks_side))};
    chunk.ranges[b] =
        range_of(chunk, first,
                 {std::min(block_side, extent.x - first.x), std::min(block_side, extent.y - first.y),
                  std::min(block_side, extent.z - first.z)});
  }
  chunk.range = chunk.ranges[0];
  for (int z = 0; z * block_side < extent.z; ++z)
    for (int y = 0; y * block_side < extent.y; ++y)
      for (int x = 0; x * block_side < extent.x; ++x) {
        const Interval& r = chunk.ranges[(z * blocks_side + y) * blocks_side + x];
        chunk.range = {std::min(chunk.range.lo, r.lo), std::max(chunk.range.hi, r.hi)};
      }
}

}  // namespace tafoni::volume::impl
