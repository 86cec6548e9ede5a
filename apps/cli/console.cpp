// Results go to standard output; warnings, errors and the line of progress to standard error, where they are
// coloured on a terminal.
#include "console.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <fmt/core.h>
#include <unistd.h>

namespace tafoni::cli {
namespace {

bool coloured() {
  const char* none = std::getenv("NO_COLOR");
  return isatty(STDERR_FILENO) != 0 && (none == nullptr || *none == '\0');
}

void print_tagged(std::string_view colour, std::string_view tag, std::string_view sentence) {
  std::string line(sentence);
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (coloured())
    fmt::print(stderr, "{}{}\x1b[0m {}\n", colour, tag, line);
  else
    fmt::print(stderr, "{} {}\n", tag, line);
}

}  // namespace

void CommonOptions::declare(Args& args) {
  args.group("Common options");
  args.flag("--json", json, "Prints results as JSON");
  args.flag("-q,--quiet", quiet, "Prints no summary, warnings or progress, only results and errors");
  args.flag("--progress", progress, "Shows progress even where standard error is no terminal");
  args.flag("--allow-network", network,
            "Lets inputs be URLs, and mosaics name such; without it nothing is fetched");
  args.integer("--threads", "N", threads, 0, 4096, "Threads to use; default: 0, which takes all cores");
}

Console::Console(const CommonOptions& options)
    : options_(options),
      terminal_(isatty(STDERR_FILENO) != 0),
      shown_(options.progress || (terminal_ && !options.quiet)) {}

Console::~Console() {
  clear();
}

void Console::print(std::string_view text) {
  if (!options_.quiet) result(text);
}

void Console::result(std::string_view text) {
  std::lock_guard lock(mutex_);
  clear();
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void Console::flush() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    fail(ErrorKind::output, "standard output could not be written; is the disk full?");
}

std::vector<std::string> Console::warnings() const {
  std::lock_guard lock(mutex_);
  return warnings_;
}

void Console::on_begin(std::string_view stage, std::uint64_t total, std::string_view unit) {
  std::lock_guard lock(mutex_);
  stage_ = stage;
  unit_ = unit;
  total_ = total;
  begun_ = Clock::now();
  if (shown_) show(0);
}

void Console::on_advance(std::uint64_t done) {
  if (!shown_) return;
  if (Clock::now().time_since_epoch().count() < next_show_.load(std::memory_order_relaxed)) return;
  std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock()) show(done);
}

void Console::on_end() {
  std::lock_guard lock(mutex_);
  clear();
}

void Console::on_warn(std::string_view sentence) {
  std::lock_guard lock(mutex_);
  if (std::find(warnings_.begin(), warnings_.end(), sentence) != warnings_.end()) return;
  warnings_.emplace_back(sentence);
  if (options_.quiet) return;
  clear();
  print_tagged("\x1b[33m", "tafoni: warning:", sentence);
}

void Console::show(std::uint64_t done) {
  const auto now = Clock::now();
  // A terminal's line is redrawn ten times a second; a log gets a line a second.
  const auto pause = std::chrono::milliseconds(terminal_ ? 100 : 1000);
  next_show_.store((now + pause).time_since_epoch().count(), std::memory_order_relaxed);
  const double seconds = std::chrono::duration<double>(now - begun_).count();
  std::string line = stage_;
  if (total_ > 0) {
    const double share = static_cast<double>(std::min(done, total_)) / static_cast<double>(total_);
    line += fmt::format("  {:3.0f} %", 100 * share);
  }
  if (done > 0 && seconds > 0.2) {
    const double rate = static_cast<double>(done) / seconds;
    const std::string number =
        rate >= 10 ? with_commas(static_cast<std::uint64_t>(rate)) : fmt::format("{:.2g}", rate);
    if (!unit_.empty()) line += fmt::format("  {} {}/s", number, unit_);
    if (total_ > done) line += "  " + as_time(static_cast<double>(total_ - done) / rate) + " left";
  }
  if (terminal_)
    fmt::print(stderr, "\r\x1b[K{}", line.substr(0, 78));
  else
    fmt::print(stderr, "{}\n", line);
  std::fflush(stderr);
  drawn_ = terminal_;
}

void Console::clear() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
  drawn_ = false;
}

void print_error(std::string_view sentence) {
  print_tagged("\x1b[31m", "tafoni:", sentence);
}

std::string with_commas(std::uint64_t n) {
  std::string digits = fmt::format("{}", n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

std::string as_bytes(std::uint64_t n) {
  const auto v = static_cast<double>(n);
  if (v < 1e3) return fmt::format("{} B", n);
  if (v < 1e6) return fmt::format("{:.1f} kB", v / 1e3);
  if (v < 1e9) return fmt::format("{:.1f} MB", v / 1e6);
  return fmt::format("{:.2f} GB", v / 1e9);
}

std::string as_time(double seconds) {
  if (seconds < 10) return fmt::format("{:.2g} s", seconds);
  if (seconds < 100) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<std::int64_t>(seconds);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

}  // namespace tafoni::cli
