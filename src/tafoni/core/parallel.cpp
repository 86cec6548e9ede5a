// Parallel loops: every loop runs in one arena that has as many threads as were asked for, and stops at the
// first exception or at a cancel.

#include "tafoni/core/parallel.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#if defined(__SANITIZE_THREAD__)
#define TAFONI_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define TAFONI_THREAD_SANITIZER
#endif
#endif
#ifdef TAFONI_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace tafoni {
namespace {

#ifdef TAFONI_THREAD_SANITIZER
/// ThreadSanitizer does not see into TBB's library, so it is told how work gets to the threads and back: what
/// was done before a loop comes before each of its blocks, and each block before what follows the loop.
/// Blocks are not put in an order with one another.
class Handover {
 public:
  Handover() { __tsan_release(&begun_); }
  ~Handover() { __tsan_acquire(&ended_); }
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;

  class Block {
   public:
    explicit Block(Handover& loop) : loop_(loop) { __tsan_acquire(&loop_.begun_); }
    ~Block() { __tsan_release(&loop_.ended_); }
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;

   private:
    Handover& loop_;
  };

 private:
  char begun_ = 0, ended_ = 0;
};
#else
struct Handover {
  struct Block {
    explicit Block(Handover&) {}
  };
};
#endif

std::mutex arena_mutex;
int requested_threads = 0;
std::shared_ptr<tbb::task_arena> arena;
std::unique_ptr<tbb::global_control> limit;

std::shared_ptr<tbb::task_arena> current_arena() {
  std::lock_guard lock(arena_mutex);
  if (!arena) {
    const int automatic = tbb::task_arena::automatic;  // a copy: the constant has no definition to bind to
    arena = std::make_shared<tbb::task_arena>(requested_threads > 0 ? requested_threads : automatic);
  }
  return arena;
}

/// Runs a loop in the arena. Isolated: a thread that waits for an inner loop must not begin another item of
/// an outer one, which would nest without end and find the thread's scratch memory in use.
template <class Loop>
void run(const Loop& loop) {
  current_arena()->execute([&] { tbb::this_task_arena::isolate(loop); });
}

}  // namespace

void set_thread_count(int threads) {
  std::lock_guard lock(arena_mutex);
  requested_threads = std::max(threads, 0);
  arena.reset();
  limit.reset();
  // Without it TBB has no more threads than cores, and says so on stderr.
  if (requested_threads > 0)
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(requested_threads));
}

int thread_count() {
  return current_arena()->max_concurrency();
}

void parallel_for(std::int64_t n, const std::function<void(std::int64_t)>& body, Progress& progress) {
  Handover loop;
  run([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::int64_t>(0, std::max<std::int64_t>(n, 0), 1),
        [&](const tbb::blocked_range<std::int64_t>& range) {
          const Handover::Block block(loop);
          for (std::int64_t i = range.begin(); i != range.end(); ++i) {
            progress.check();
            body(i);
            progress.advance();
          }
        },
        tbb::simple_partitioner());
  });
}

void parallel_blocks(std::int64_t n, std::int64_t grain,
                     const std::function<void(std::int64_t, std::int64_t)>& body) {
  if (n <= 0) return;
  grain = std::max<std::int64_t>(grain, 1);
  const std::int64_t blocks = (n + grain - 1) / grain;
  Handover loop;
  run([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::int64_t>(0, blocks, 1),
        [&](const tbb::blocked_range<std::int64_t>& range) {
          const Handover::Block block(loop);
          for (std::int64_t b = range.begin(); b != range.end(); ++b)
            body(b * grain, std::min(n, (b + 1) * grain));
        },
        tbb::simple_partitioner());
  });
}

}  // namespace tafoni
