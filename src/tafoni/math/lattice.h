#pragma once
// Numbers and bounds of samples.

#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni {

/// Which sample of a lattice of n lies at `index` in an array of all: the inverse of sample_index().
constexpr Vec3i sample_at(Vec3i n, std::int64_t index) {
  const std::int64_t row = index / n.x;
  return {static_cast<std::int32_t>(index % n.x), static_cast<std::int32_t>(row % n.y),
          static_cast<std::int32_t>(row / n.y)};
}

/// Bounds that were worked out in double. Each is rounded to the nearest, maybe inward: whoever calls leaves
/// slack.
constexpr Interval rounded(double lo, double hi) {
  return {static_cast<float>(lo), static_cast<float>(hi)};
}

}  // namespace tafoni
