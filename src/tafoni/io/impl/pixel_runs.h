#pragma once
// Pixels that have no height, as runs in the order of rows.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace tafoni::io::impl {

class PixelRuns {
 public:
  bool empty() const { return runs_.empty(); }

  /// Pixels [begin, end), beyond all that were added before.
  void add(std::uint64_t begin, std::uint64_t end) {
    if (begin >= end) return;
    if (!runs_.empty() && runs_.back().end == begin)
      runs_.back().end = end;
    else
      runs_.push_back({begin, end});
  }

  /// Sets those among [begin, begin + count) to NaN in out[count].
  void clear(std::uint64_t begin, std::uint64_t count, double* out) const {
    const std::uint64_t end = begin + count;
    auto run =
        std::upper_bound(runs_.begin(), runs_.end(), begin, [](std::uint64_t v, Run r) { return v < r.end; });
    for (; run != runs_.end() && run->begin < end; ++run)
      std::fill(out + (std::max(run->begin, begin) - begin), out + (std::min(run->end, end) - begin),
                std::numeric_limits<double>::quiet_NaN());
  }

 private:
  struct Run {
    std::uint64_t begin, end;
  };
  std::vector<Run> runs_;
};

}  // namespace tafoni::io::impl
