#pragma once
// Edits of one chunk of a scalar grid, row by row.

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

#include "tafoni/volume/impl/grid_chunk.h"

namespace tafoni::volume::impl {

inline bool covers(const SampleBox& outer, const SampleBox& inner) {
  return outer.lo.x <= inner.lo.x && outer.lo.y <= inner.lo.y && outer.lo.z <= inner.lo.z &&
         outer.hi.x >= inner.hi.x && outer.hi.y >= inner.hi.y && outer.hi.z >= inner.hi.z;
}

inline SampleBox common(const SampleBox& a, const SampleBox& b) {
  return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
          {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
}

inline void expand(SampleBox& box, const SampleBox& by) {
  if (by.empty()) return;
  if (box.empty()) {
    box = by;
    return;
  }
  box = {{std::min(box.lo.x, by.lo.x), std::min(box.lo.y, by.lo.y), std::min(box.lo.z, by.lo.z)},
         {std::max(box.hi.x, by.hi.x), std::max(box.hi.y, by.hi.y), std::max(box.hi.z, by.hi.z)}};
}

inline std::uint32_t bits(float v) {
  return std::bit_cast<std::uint32_t>(v);
}

/// n samples of a slot from `index` on.
inline void read_row(const Slot& slot, int index, int n, float* out) {
  const GridChunk* chunk = slot.chunk.get();
  if (!chunk)
    std::fill_n(out, n, slot.value);
  else if (chunk->single)
    std::memcpy(out, chunk->single.get() + index, n * sizeof(float));
  else
    from_half(chunk->half.get() + index, n, out);
}

/// What a row looks like once it is stored.
inline void round_row(Precision precision, std::span<float> row) {
  if (precision == Precision::single) return;
  std::uint16_t halves[side];
  to_half(row.data(), row.size(), halves);
  from_half(halves, row.size(), row.data());
}

/// Writes the rows of one chunk that differ, owns the chunk from the first of them on, and leaves the ranges
/// right even if the caller's function throws.
class ChunkEditor {
 public:
  ChunkEditor(Slot& slot, Precision precision, const SampleBox& whole)
      : slot_(slot), precision_(precision), whole_(whole) {}
  ChunkEditor(const ChunkEditor&) = delete;
  ChunkEditor& operator=(const ChunkEditor&) = delete;
  ~ChunkEditor() {
    if (touched_) impl::update_ranges(slot_.chunk.mine(), touched_, whole_.size());
  }

  /// change(first, row) over the rows of `part`. Gives the box of what changed.
  template <class F>
  SampleBox rows(const SampleBox& part, const F& change) {
    SampleBox changed;
    const int from = part.lo.x - whole_.lo.x, n = part.size().x;
    // Whole rows are copied, since copies of known size are quicker.
    alignas(64) float copy[side], now[side];
    for (int z = part.lo.z; z <= part.hi.z; ++z)
      for (int y = part.lo.y; y <= part.hi.y; ++y) {
        const int at = GridChunk::index(0, y - whole_.lo.y, z - whole_.lo.z);
        // Stored single precision is its own copy.
        const GridChunk* chunk = slot_.chunk.get();
        const float* old = chunk && chunk->single ? chunk->single.get() + at : copy;
        if (old == copy) read_row(slot_, at, side, copy);
        std::memcpy(now, old, sizeof now);
        const std::span<float> row(now + from, n);
        change(Vec3i{part.lo.x, y, z}, row);
        round_row(precision_, row);
        std::uint32_t differs = 0;
        for (int i = 0; i < side; ++i) differs |= bits(old[i]) ^ bits(now[i]);
        if (!differs) continue;
        int a = from, b = from + n - 1;
        while (bits(old[a]) == bits(now[a])) ++a;
        while (bits(old[b]) == bits(now[b])) --b;
        store(at + a, now + a, b - a + 1);
        expand(changed, {{whole_.lo.x + a, y, z}, {whole_.lo.x + b, y, z}});
      }
    return changed;
  }

 private:
  void store(int at, const float* row, int n) {
    GridChunk& chunk = impl::own(slot_, precision_);
    if (chunk.single)
      std::copy_n(row, n, chunk.single.get() + at);
    else
      to_half(row, n, chunk.half.get() + at);
    const int x = at % side, y = at / side % side, z = at / (side * side);
    const int block = ((z / impl::block_side) * impl::blocks_side + y / impl::block_side) * impl::blocks_side;
    for (int b = x / impl::block_side; b <= (x + n - 1) / impl::block_side; ++b)
      touched_ |= std::uint64_t{1} << (block + b);
  }

  Slot& slot_;
  Precision precision_;
  SampleBox whole_;
  std::uint64_t touched_ = 0;
};

}  // namespace tafoni::volume::impl
