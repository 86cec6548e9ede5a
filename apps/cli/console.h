#pragma once
// Results on stdout; progress and warnings on stderr. All text that leaves the program for a terminal goes
// through here, where it is made safe.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "args.h"
#include <nlohmann/json_fwd.hpp>

#include "tafoni/core/error.h"
#include "tafoni/core/progress.h"

namespace tafoni::cli {

/// Options that every subcommand has.
struct CommonOptions {
  bool json = false, quiet = false, progress = false, network = false, outside = false;
  std::optional<std::int64_t> threads;

  void declare(Args& args);
};

/// `text` as a terminal may be sent it. Bytes that drive a terminal, direct its text from right to left or
/// are no UTF-8 become \u001B and the like, which reads the same within JSON; line breaks and tabs stay.
std::string terminal_safe(std::string_view text);
/// terminal_safe() on one line, of which the middle is left out where it is longer than a person reads.
std::string terminal_sentence(std::string_view text);

class Console : public Progress {
 public:
  explicit Console(const CommonOptions& options);
  ~Console() override;

  bool json() const { return options_.json; }
  bool quiet() const { return options_.quiet; }
  /// Prints what was done to stdout, but nothing with --quiet.
  void print(std::string_view text);
  /// What the command exists for, on stdout, --quiet or not.
  void result(std::string_view text);
  /// Throws Error{output} when stdout could not take everything.
  void flush();
  std::vector<std::string> warnings() const;

 protected:
  void on_begin(std::string_view stage, std::uint64_t total, std::string_view unit) override;
  void on_advance(std::uint64_t done) override;
  void on_end() override;
  void on_warn(std::string_view sentence) override;

 private:
  using Clock = std::chrono::steady_clock;
  void show(std::uint64_t done);
  void clear();

  CommonOptions options_;
  bool terminal_ = false, shown_ = false, drawn_ = false;
  mutable std::mutex mutex_;
  std::string stage_, unit_;
  std::uint64_t total_ = 0;
  Clock::time_point begun_;
  std::atomic<std::int64_t> next_show_{0};  ///< steady clock ticks
  std::vector<std::string> warnings_;
};

/// "tafoni: sentence" on stderr, in red on a terminal unless NO_COLOR is set; with `json`
/// {"error": sentence, "kind": "input", "code": 3} on one line.
void print_error(const Error& error, bool json);

/// Indented, on lines of its own. Text of files need not be UTF-8, which JSON must be: what is not is
/// replaced.
std::string json_text(const nlohmann::ordered_json& json);

/// 1234567 as "1,234,567".
std::string with_commas(std::uint64_t n);
/// Bytes as "12.3 MB".
std::string as_bytes(std::uint64_t n);
/// Seconds as "0.42 s", "3 min 20 s".
std::string as_time(double seconds);

}  // namespace tafoni::cli
