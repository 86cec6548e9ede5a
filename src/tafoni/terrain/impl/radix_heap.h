#pragma once
// A priority queue for keys that never fall below the last one taken out [Ahuja90], which is how a
// flood rises. Several times as fast as a binary heap on millions of cells.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tafoni::terrain::impl {

/// An unsigned key in the order of the floats, NaN excepted; -0 before +0.
inline std::uint32_t float_key(float v) {
  const auto bits = std::bit_cast<std::uint32_t>(v);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

class RadixHeap {
 public:
  struct Item {
    std::uint32_t key, value;
  };

  bool empty() const { return size_ == 0; }

  /// `key` must not be below that of the last pop().
  void push(std::uint32_t key, std::uint32_t value) {
    const std::size_t b = bucket(key);
    if (buckets_[b].empty() || key < least_[b]) least_[b] = key;
    buckets_[b].push_back({key, value});
    ++size_;
  }

  /// The least key. Leaves the heap as it is, so lower keys than this may still come.
  std::uint32_t top() const { return least_[first()]; }

  /// An item of the least key.
  Item pop() {
    if (buckets_[0].empty()) settle(first());
    const Item item = buckets_[0].back();
    buckets_[0].pop_back();
    --size_;
    return item;
  }

 private:
  /// Bucket 0 holds keys equal to last_; bucket b those whose highest bit that differs from it is b - 1.
  std::size_t bucket(std::uint32_t key) const { return std::bit_width(key ^ last_); }

  std::size_t first() const {
    std::size_t b = 0;
    while (buckets_[b].empty()) ++b;
    return b;
  }

  /// Every key of bucket b agrees with its least one in more leading bits than with last_.
  void settle(std::size_t b) {
    last_ = least_[b];
    moving_.swap(buckets_[b]);
    size_ -= moving_.size();
    for (const Item& item : moving_) push(item.key, item.value);
    moving_.clear();
    // Gives the memory back to the bucket it came from.
    moving_.swap(buckets_[b]);
  }

  std::array<std::vector<Item>, 33> buckets_;
  std::array<std::uint32_t, 33> least_{};
  std::vector<Item> moving_;
  std::uint32_t last_ = 0;
  std::size_t size_ = 0;
};

}  // namespace tafoni::terrain::impl
