#include "tafoni/core/parallel.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tafoni {
namespace {

class Threads : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(0); }
};

TEST_P(Threads, EveryItemOnceAndCounted) {
  struct Counter : Progress {
    void on_advance(std::uint64_t done) override {
      std::uint64_t seen = most.load();
      while (seen < done && !most.compare_exchange_weak(seen, done)) {
      }
    }
    std::atomic<std::uint64_t> most{0};
  } progress;
  std::vector<std::atomic<int>> hits(1000);
  progress.begin("count", hits.size());
  parallel_for(
      1000, [&](std::int64_t i) { ++hits[i]; }, progress);
  for (const auto& hit : hits) EXPECT_EQ(hit.load(), 1);
  EXPECT_EQ(progress.most.load(), 1000u);
}

TEST_P(Threads, AnItemThatWaitsForAnInnerLoopIsNotInterruptedByAnotherItem) {
  static thread_local int depth = 0;
  std::atomic<int> deepest{0};
  parallel_for(60, [&](std::int64_t) {
    ++depth;
    int seen = deepest.load();
    while (seen < depth && !deepest.compare_exchange_weak(seen, depth)) {
    }
    parallel_blocks(
        4, 1, [](std::int64_t, std::int64_t) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
    --depth;
  });
  EXPECT_EQ(deepest.load(), 1);
}

TEST_P(Threads, BlocksTileTheRange) {
  for (const std::int64_t n : {0, 1, 9, 10, 11, 1003}) {
    std::vector<std::atomic<int>> hits(n);
    parallel_blocks(n, 10, [&](std::int64_t begin, std::int64_t end) {
      EXPECT_LE(end - begin, 10);
      EXPECT_LT(begin, end);
      for (std::int64_t i = begin; i < end; ++i) ++hits[i];
    });
    for (const auto& hit : hits) EXPECT_EQ(hit.load(), 1);
  }
}

TEST_P(Threads, ExceptionsReachTheCaller) {
  const auto body = [](std::int64_t i) {
    if (i == 37) throw std::runtime_error("37");
  };
  EXPECT_THROW(parallel_for(100, body), std::runtime_error);
}

TEST_P(Threads, CancelStops) {
  Progress progress;
  std::atomic<int> ran{0};
  const auto body = [&](std::int64_t) {
    if (++ran == 5) progress.cancel();
  };
  EXPECT_THROW(parallel_for(100000, body, progress), Error);
  EXPECT_LT(ran.load(), 1000);
}

TEST_P(Threads, LoopsNest) {
  std::atomic<int> sum{0};
  parallel_for(8, [&](std::int64_t) { parallel_for(8, [&](std::int64_t) { ++sum; }); });
  EXPECT_EQ(sum.load(), 64);
}

INSTANTIATE_TEST_SUITE_P(Counts, Threads, testing::Values(0, 1, 2, 7));

TEST(Parallel, ThreadCountIsWhatWasAsked) {
  set_thread_count(3);
  EXPECT_EQ(thread_count(), 3);
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1);
}

TEST(Parallel, NothingToDo) {
  parallel_for(0, [](std::int64_t) { FAIL(); });
  parallel_for(-5, [](std::int64_t) { FAIL(); });
}

}  // namespace
}  // namespace tafoni
