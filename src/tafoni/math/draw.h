#pragma once
// Random numbers in the types that shapes and indices have.

#include <cstdint>

#include "tafoni/core/random.h"

namespace tafoni {

/// Uniform in [0, 1): the upper 53 bits of a number from Random::at().
constexpr double unit_real(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}
/// The next index of a list of n.
constexpr int draw_index(Random& random, std::int64_t n) {
  return static_cast<int>(random.below(n));
}
/// The next real number, rounded to what a primitive or a sample holds.
constexpr float draw_float(Random& random, double lo, double hi) {
  return static_cast<float>(random.uniform(lo, hi));
}

}  // namespace tafoni
