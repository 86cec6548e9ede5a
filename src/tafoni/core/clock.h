#pragma once
// How long things take.

#include <chrono>

namespace tafoni {

/// Seconds on a clock that only goes forward; differences alone mean something.
inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace tafoni
