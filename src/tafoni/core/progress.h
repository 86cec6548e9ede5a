#pragma once
// Progress, warnings and cancellation: one object travels from the caller down to every long loop.

#include <atomic>
#include <cstdint>
#include <string_view>

#include "tafoni/core/error.h"

namespace tafoni {

/// Receives progress from any thread. The base class shows nothing; a front end overrides the hooks.
class Progress {
 public:
  Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  virtual ~Progress() = default;

  /// Starts a stage of `total` steps (0: unknown) counted in `unit`.
  void begin(std::string_view stage, std::uint64_t total = 0, std::string_view unit = "") {
    done_ = 0;
    on_begin(stage, total, unit);
    check();
  }
  /// Counts steps done; throws Error{cancelled} once cancel() was called.
  void advance(std::uint64_t steps = 1) {
    on_advance(done_.fetch_add(steps, std::memory_order_relaxed) + steps);
    check();
  }
  void end() { on_end(); }
  /// Something the user should know although the work goes on.
  void warn(std::string_view sentence) {
    warned_.fetch_add(1, std::memory_order_relaxed);
    on_warn(sentence);
  }
  /// How many warnings there were.
  std::uint64_t warned() const { return warned_.load(std::memory_order_relaxed); }

  /// Safe in a signal handler.
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
  void check() const {
    if (cancelled()) throw Error(ErrorKind::cancelled, "cancelled");
  }

 protected:
  virtual void on_begin(std::string_view, std::uint64_t /*total*/, std::string_view /*unit*/) {}
  virtual void on_advance(std::uint64_t /*done*/) {}
  virtual void on_end() {}
  virtual void on_warn(std::string_view) {}

 private:
  std::atomic<std::uint64_t> done_{0}, warned_{0};
  std::atomic<bool> cancelled_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

/// A Progress that shows nothing, for callers who want none.
inline Progress& silent() {
  static Progress none;
  return none;
}

}  // namespace tafoni
