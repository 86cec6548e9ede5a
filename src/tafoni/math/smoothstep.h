#pragma once
// The one S-curve: 0, then smoothly up, then 1.

namespace tafoni {

/// 3 t² − 2 t³ of t in [0, 1]: its slope is 0 at both ends.
template <class T>
constexpr T smoothstep(T t) {
  return t * t * (3 - 2 * t);
}

/// 0 below a, 1 above b, smooth between; a < b.
template <class T>
constexpr T smoothstep(T a, T b, T x) {
  return smoothstep(x <= a ? T(0) : x >= b ? T(1) : (x - a) / (b - a));
}

}  // namespace tafoni
