#include "tafoni/raster/jumps.h"

#include <cmath>

namespace tafoni::raster {

void JumpSearch::look(const float* from, const float* to, std::size_t count) {
  // Most rows have none, and are only counted.
  int found = 0;
  for (std::size_t i = 0; i < count; ++i) found += std::abs(from[i] - to[i]) > limit_ ? 1 : 0;
  if (found == 0) return;
  jumps_.count += found;
  for (std::size_t i = 0; i < count; ++i)
    if (const double height = std::abs(from[i] - to[i]); height > limit_ && height > jumps_.height)
      jumps_ = {jumps_.count, height, static_cast<int>(i), row_};
}

void JumpSearch::add(std::span<const float> row) {
  if (row.size() > 1) look(row.data(), row.data() + 1, row.size() - 1);
  if (above_.size() == row.size()) look(row.data(), above_.data(), row.size());
  above_.assign(row.begin(), row.end());
  ++row_;
}

void JumpSearch::skip(int rows) {
  above_.clear();
  row_ += rows;
}

}  // namespace tafoni::raster
