#pragma once
// A hash of all samples of a grid that follows its edits.

#include <cstdint>
#include <vector>

#include "tafoni/volume/scalar_grid.h"

namespace tafoni::runtime::impl {

/// The same for equal samples, whether chunks are held in full or as one value.
class StateHash {
 public:
  explicit StateHash(const volume::ScalarGrid& grid);
  /// Samples in the box may have changed.
  void touch(const volume::SampleBox& box);
  std::uint64_t of(const volume::ScalarGrid& grid);

 private:
  Vec3i chunks_;
  std::vector<std::uint64_t> hashes_;
  std::vector<bool> stale_;
  std::vector<std::size_t> list_;  ///< of those stale
  std::uint64_t sum_ = 0;
};

}  // namespace tafoni::runtime::impl
