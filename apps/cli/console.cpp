// Results go to standard output; warnings, errors and the line of progress to standard error, where they are
// coloured on a terminal.
#include "console.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tafoni::cli {
namespace {

// A sentence is cut to about so many bytes of its beginning, which names the file, and of its end, which says
// what to do.
constexpr std::size_t longest_head = 400, longest_tail = 200;

/// What is written to standard error may be lost, but may not end the program.
void tell(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

bool coloured() {
  const char* none = std::getenv("NO_COLOR");
  return isatty(STDERR_FILENO) != 0 && (none == nullptr || *none == '\0');
}

void print_tagged(std::string_view colour, std::string_view tag, std::string_view sentence) {
  const std::string line = terminal_sentence(sentence);
  if (coloured())
    tell(fmt::format("{}{}\x1b[0m {}\n", colour, tag, line));
  else
    tell(fmt::format("{} {}\n", tag, line));
}

const char* kind_name(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::internal:
      return "internal";
    case ErrorKind::usage:
      return "usage";
    case ErrorKind::input:
      return "input";
    case ErrorKind::output:
      return "output";
    case ErrorKind::invalid:
      return "invalid";
    case ErrorKind::cancelled:
      return "cancelled";
  }
  return "";
}

/// On one line: bytes that are no UTF-8, which JSON must be, are replaced.
void tell_json(const nlohmann::ordered_json& json) {
  tell(terminal_safe(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) + "\n");
}

bool plain(char c) {
  return (c >= ' ' && c <= '~') || c == '\n' || c == '\t';
}

/// The code point that begins `text` and how many bytes it has; 1 byte of none where that is no UTF-8.
struct CodePoint {
  std::optional<std::uint32_t> value;
  std::size_t bytes = 1;
};
CodePoint first_code_point(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = at(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  std::uint32_t value = lead & (0xffu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((at(i) & 0xc0u) != 0x80) return {};
    value = value << 6 | (at(i) & 0x3fu);
  }
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  if (value < least[bytes] || value > 0x10ffff || (value >= 0xd800 && value <= 0xdfff)) return {};
  return {value, bytes};
}

/// Controls, line breaks of all scripts, and what changes the direction of the text after it.
bool drives_terminal(std::uint32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x61c || c == 0x200e || c == 0x200f ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/// The end of the last whole code point within `text`'s first `size` bytes.
std::size_t cut_at(std::string_view text, std::size_t size) {
  while (size > 0 && size < text.size() && (static_cast<unsigned char>(text[size]) & 0xc0u) == 0x80) --size;
  return size;
}

}  // namespace

std::string terminal_safe(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t begin = i;
    while (i < text.size() && plain(text[i])) ++i;
    out += text.substr(begin, i - begin);
    if (i == text.size()) break;
    const CodePoint point = first_code_point(text.substr(i));
    if (!point.value)
      out += fmt::format("\\u{:04X}", static_cast<unsigned char>(text[i]));
    else if (!drives_terminal(*point.value))
      out += text.substr(i, point.bytes);
    else
      out += fmt::format("\\u{:04X}", *point.value);
    i += point.bytes;
  }
  return out;
}

std::string terminal_sentence(std::string_view text) {
  std::string line = terminal_safe(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (line.size() <= longest_head + longest_tail) return line;
  const std::size_t head = cut_at(line, longest_head), tail = cut_at(line, line.size() - longest_tail);
  return line.substr(0, head) + " … " + line.substr(tail);
}

void CommonOptions::declare(Args& args) {
  args.group("Common options");
  args.flag("--json", json, "Prints results as JSON");
  args.flag("-q,--quiet", quiet, "Prints no summary, warnings or progress, only results and errors");
  args.flag("--progress", progress, "Shows progress even where standard error is no terminal");
  args.flag("--allow-network", network,
            "Lets inputs be URLs, and mosaics name such; without it nothing is fetched");
  args.flag("--allow-outside", outside,
            "Lets mosaics (.vrt) name files outside of their own folder; for those that you made or know");
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
  if (!std::all_of(text.begin(), text.end(), plain)) {
    const std::string safe = terminal_safe(text);
    std::fwrite(safe.data(), 1, safe.size(), stdout);
    return;
  }
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
  if (options_.json)
    tell_json({{"warning", terminal_sentence(sentence)}});
  else
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
  line = terminal_sentence(line);
  tell(terminal_ ? "\r\x1b[K" + line.substr(0, cut_at(line, std::min<std::size_t>(line.size(), 78)))
                 : line + "\n");
  std::fflush(stderr);
  drawn_ = terminal_;
}

void Console::clear() {
  if (drawn_) tell("\r\x1b[K");
  drawn_ = false;
}

void print_error(const Error& error, bool json) {
  if (json)
    tell_json({{"error", terminal_sentence(error.what())},
               {"kind", kind_name(error.kind())},
               {"code", static_cast<int>(error.kind())}});
  else
    print_tagged("\x1b[31m", "tafoni:", error.what());
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
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
