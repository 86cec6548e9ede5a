#include "command_files.h"

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/core/files.h"

namespace tafoni::cli {

namespace fs = std::filesystem;

namespace {

/// Takes "_12" off the end of a name.
std::optional<std::int64_t> take_number(std::string_view& name) {
  const std::size_t at = name.rfind('_');
  if (at == std::string_view::npos) return {};
  std::int64_t number = -1;
  const char* end = name.data() + name.size();
  const auto [last, error] = std::from_chars(name.data() + at + 1, end, number);
  if (error != std::errc() || last != end || number < 0) return {};
  name = name.substr(0, at);
  return number;
}

/// Whether a file is one of N x N tiles, of which there may be too many to look at.
bool is_tile(const fs::path& file, const fs::path& path, std::int64_t n) {
  const std::string stem = follow_links(file).stem().string();
  std::string_view name = stem;
  const auto y = take_number(name), x = take_number(name);
  return x && y && *x < n && *y < n && same_file(file, tile_name(path, *x, *y));
}

}  // namespace

fs::path tile_name(const fs::path& path, std::int64_t x, std::int64_t y) {
  return path.parent_path() /
         fmt::format("{}_{}_{}{}", path.stem().string(), x, y, path.extension().string());
}

void CommandFiles::reads(const fs::path& path) {
  if (path.empty() || path == "-") return;
  for (const Output& output : outputs_) check_input(output, path);
  inputs_.push_back(path);
}

void CommandFiles::writes(const fs::path& path) {
  if (!path.empty()) add({path});
}

void CommandFiles::writes_tiles(const fs::path& path, std::int64_t n) {
  add({path, n});
}

bool CommandFiles::meet(const Output& a, const Output& b) {
  if (a.tiles > 0 && b.tiles == 0) return is_tile(b.path, a.path, a.tiles);
  if (b.tiles > 0 && a.tiles == 0) return is_tile(a.path, b.path, b.tiles);
  return same_file(a.path, b.path);
}

void CommandFiles::check_input(const Output& output, const fs::path& input) {
  if (!meet(output, {input})) return;
  const std::string what = output.path == input ? "" : fmt::format("as {} ", input.string());
  fail(ErrorKind::usage, "{}: {}is an input of this command and would be overwritten; choose another name",
       output.path.string(), what);
}

void CommandFiles::add(const Output& output) {
  for (const fs::path& input : inputs_) check_input(output, input);
  for (const Output& other : outputs_) {
    if (!meet(output, other)) continue;
    const std::string what = output.path == other.path ? "" : fmt::format(", as {}", other.path.string());
    fail(ErrorKind::usage, "{}: is asked for twice{}; give each output a name of its own",
         output.path.string(), what);
  }
  if (output.tiles > 0) {
    const AtomicFile first(tile_name(output.path, 0, 0));
    const AtomicFile last(tile_name(output.path, output.tiles - 1, output.tiles - 1));
  } else {
    const AtomicFile probe(output.path);
  }
  outputs_.push_back(output);
}

void check_output(const fs::path& path, const std::vector<fs::path>& inputs) {
  CommandFiles files;
  for (const fs::path& input : inputs) files.reads(input);
  files.writes(path);
}

}  // namespace tafoni::cli
