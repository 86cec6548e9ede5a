// GDAL's names have no common grammar, but each holds the path of a file: that is looked for.

#include "tafoni/io/source_name.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

namespace tafoni::io {
namespace {

namespace fs = std::filesystem;

class Splitter {
 public:
  explicit Splitter(const fs::path& directory) : directory_(directory) {}

  std::optional<SourceName> split(std::string_view name) const {
    if (name.starts_with("/vsi")) return in_archive(name);
    if (is_there(name)) return SourceName{"", name, ""};
    return in_driver(name);
  }

 private:
  bool is_there(std::string_view name) const {
    std::error_code error;
    return !name.empty() && fs::exists(directory_ / fs::path(name), error);
  }

  bool is_file(std::string_view name) const {
    std::error_code error;
    return fs::is_regular_file(directory_ / fs::path(name), error);
  }

  /// "/vsizip/", one or several of them, a file, and what is in it.
  std::optional<SourceName> in_archive(std::string_view name) const {
    std::size_t begin = 0;
    while (name.substr(begin).starts_with("/vsi")) {
      const auto slash = name.find('/', begin + 1);
      if (slash == std::string_view::npos) return std::nullopt;
      begin = slash + 1;
    }
    if (name.substr(begin).starts_with('{')) ++begin;
    for (std::size_t end = begin; end < name.size();) {
      end = std::min(name.find_first_of("/}", end + 1), name.size());
      const std::string_view file = name.substr(begin, end - begin);
      if (is_file(file))
        return SourceName{std::string(name.substr(0, begin)), file, std::string(name.substr(end))};
    }
    return std::nullopt;
  }

  /// "NETCDF:", the file, with or without quotes, and which part of it; or parts and then the file.
  std::optional<SourceName> in_driver(std::string_view name) const {
    bool quoted = false;
    std::size_t begin = 0;
    for (std::size_t at = 0; at <= name.size(); ++at) {
      if (at < name.size() && name[at] == '"') quoted = !quoted;
      if (at < name.size() && (name[at] != ':' || quoted)) continue;
      std::size_t first = begin, last = at;
      if (last - first >= 2 && name[first] == '"' && name[last - 1] == '"') ++first, --last;
      // The first part is the driver's name.
      if (const auto inner = begin == 0 ? std::nullopt : split_part(name.substr(first, last - first)))
        return SourceName{std::string(name.substr(0, first)) + inner->before, inner->file,
                          inner->after + std::string(name.substr(last))};
      begin = at + 1;
    }
    return std::nullopt;
  }

  std::optional<SourceName> split_part(std::string_view part) const {
    if (part.starts_with("/vsi")) return in_archive(part);
    if (is_file(part)) return SourceName{"", part, ""};
    return std::nullopt;
  }

  const fs::path& directory_;
};

/// Whether a name begins as those do that GDAL's drivers take.
bool names_driver(std::string_view name) {
  const auto colon = name.find(':');
  return colon != std::string_view::npos && colon > 1 &&
         std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(colon),
                     [](unsigned char c) { return std::isupper(c) || std::isdigit(c) || c == '_'; });
}

}  // namespace

SourceName split_source(const std::string& name, const fs::path& directory) {
  if (auto found = Splitter(directory).split(name)) return *found;
  if (name.starts_with("/vsi") || names_driver(name)) return {name, {}, {}};
  return {{}, name, {}};
}

}  // namespace tafoni::io
