// A sum of one hash a chunk of samples, so that only the chunks that edits touched are hashed again.

#include "tafoni/runtime/impl/state_hash.h"

#include <algorithm>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/runtime/impl/bytes.h"

namespace tafoni::runtime::impl {
namespace {

constexpr int side = volume::ScalarGrid::chunk_samples;

std::uint64_t hash_of(const volume::ScalarGrid& grid, Vec3i chunk, std::size_t index) {
  const volume::SampleBox all = grid.samples();
  const Vec3i lo = {chunk.x * side, chunk.y * side, chunk.z * side};
  const volume::SampleBox box{lo,
                              {std::min(lo.x + side - 1, all.hi.x), std::min(lo.y + side - 1, all.hi.y),
                               std::min(lo.z + side - 1, all.hi.z)}};
  const Vec3i n = box.size();
  float first = 0;
  std::uint64_t hash = 0;
  if (!grid.uniform(chunk, &first)) {
    std::vector<float> values(n.x * n.y * n.z);
    grid.read(box, values.data());
    first = values[0];
    const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
    const bool same =
        std::all_of(values.begin(), values.end(), [&](float v) { return bits(v) == bits(first); });
    if (!same) hash = checksum(std::as_bytes(std::span(values)), index);
  }
  return hash ? hash : hash_combine(index, std::bit_cast<std::uint32_t>(first));
}

}  // namespace

StateHash::StateHash(const volume::ScalarGrid& grid) : chunks_(grid.chunks()) {
  hashes_.resize(std::int64_t{chunks_.x} * chunks_.y * chunks_.z);
  stale_.resize(hashes_.size());
  touch(grid.samples());
}

void StateHash::touch(const volume::SampleBox& box) {
  if (box.empty()) return;
  for (int c = box.lo.z / side; c <= box.hi.z / side; ++c)
    for (int b = box.lo.y / side; b <= box.hi.y / side; ++b)
      for (int a = box.lo.x / side; a <= box.hi.x / side; ++a) {
        const std::int64_t index = (std::int64_t{c} * chunks_.y + b) * chunks_.x + a;
        if (stale_[index]) continue;
        stale_[index] = true;
        list_.push_back(index);
      }
}

std::uint64_t StateHash::of(const volume::ScalarGrid& grid) {
  std::vector<std::uint64_t> now(list_.size());
  parallel_blocks(std::ssize(list_), 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const std::int64_t index = list_[i];
      now[i] = hash_of(grid,
                       {static_cast<int>(index % chunks_.x), static_cast<int>(index / chunks_.x % chunks_.y),
                        static_cast<int>(index / chunks_.x / chunks_.y)},
                       list_[i]);
    }
  });
  for (std::size_t i = 0; i < list_.size(); ++i) {
    sum_ += now[i] - hashes_[list_[i]];
    hashes_[list_[i]] = now[i];
    stale_[list_[i]] = false;
  }
  list_.clear();
  return sum_;
}

}  // namespace tafoni::runtime::impl
