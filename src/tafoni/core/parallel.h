#pragma once
// Parallel loops over oneTBB, with cancellation. Bodies must not depend on the order or the thread.

#include <cstdint>
#include <functional>

#include "tafoni/core/progress.h"

namespace tafoni {

/// Threads used by every loop below; 0 asks for all cores. Default: all.
void set_thread_count(int threads);
int thread_count();

/// body(i) for i in [0, n), in any order. Advances `progress` by one an item; an exception or a cancel
/// stops the loop and is rethrown here.
void parallel_for(std::int64_t n, const std::function<void(std::int64_t)>& body,
                  Progress& progress = silent());

/// body(begin, end) over blocks of at most `grain` items that tile [0, n). Does not touch any progress
/// counter.
void parallel_blocks(std::int64_t n, std::int64_t grain,
                     const std::function<void(std::int64_t, std::int64_t)>& body);

}  // namespace tafoni
