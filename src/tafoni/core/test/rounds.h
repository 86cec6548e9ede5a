#pragma once
// How often a random test tries.

namespace tafoni {

/// A fifth of `all` in sanitized builds. These are a tenth as fast, and look for what no plain build shows;
/// wrong values are found by the plain one.
constexpr int rounds(int all) {
#ifdef TAFONI_SANITIZED
  return all / 5;
#else
  return all;
#endif
}

}  // namespace tafoni
