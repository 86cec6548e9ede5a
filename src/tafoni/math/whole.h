#pragma once
// Real numbers to whole ones. The result must fit: what lies outside of it is the caller's to clamp.

#include <cmath>

namespace tafoni {

template <class Int = int>
inline Int floor_to(double v) {
  return static_cast<Int>(std::floor(v));
}
template <class Int = int>
inline Int ceil_to(double v) {
  return static_cast<Int>(std::ceil(v));
}
/// The nearest; halves go away from zero.
template <class Int = int>
inline Int round_to(double v) {
  return static_cast<Int>(std::llround(v));
}

}  // namespace tafoni
