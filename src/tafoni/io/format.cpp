// Which format a file's extension means, and the sentence for an extension that no format has.

#include "tafoni/io/format.h"

#include <algorithm>
#include <cctype>

#include <fmt/ranges.h>

#include "tafoni/core/error.h"

namespace tafoni::io {
namespace {

bool can(const FormatType& format, Ability ability) {
  switch (ability) {
    case Ability::write_mesh:
      return format.write_mesh != nullptr;
    case Ability::read_mesh:
      return format.read_mesh != nullptr;
    case Ability::write_image:
      return format.write_image != nullptr;
    case Ability::write_volume:
      return format.write_volume != nullptr;
    case Ability::read_volume:
      return format.open_volume != nullptr;
  }
  return false;
}

std::vector<std::string> known_extensions(std::initializer_list<Ability> abilities) {
  std::vector<std::string> known;
  for (const FormatType* format : all_formats())
    if (std::ranges::any_of(abilities, [&](Ability ability) { return can(*format, ability); }))
      known.insert(known.end(), format->extensions.begin(), format->extensions.end());
  return known;
}

const FormatType* find(std::string_view extension, Ability ability) {
  for (const FormatType* format : all_formats())
    if (can(*format, ability) && std::ranges::find(format->extensions, extension) != format->extensions.end())
      return format;
  return nullptr;
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

const FormatType& find_format(std::string_view name) {
  return tafoni::find(all_formats(), name, "format");
}

bool can(const std::filesystem::path& path, Ability ability) {
  return find(lower_extension(path), ability) != nullptr;
}

const FormatType& format_of(const std::filesystem::path& path, std::initializer_list<Ability> abilities) {
  static constexpr const char* verbs[] = {"written as a mesh", "read as a mesh", "written as a picture",
                                          "written as a volume", "read as a volume"};
  const std::string extension = lower_extension(path);
  std::string what;
  for (const Ability ability : abilities) {
    if (const FormatType* format = find(extension, ability)) return *format;
    what += (what.empty() ? "" : " or ") + std::string(verbs[static_cast<int>(ability)]);
  }
  const std::vector<std::string> known = known_extensions(abilities);
  const std::string near = nearest(extension, known);
  fail(ErrorKind::usage, "{}: a file with {} cannot be {}; {}known extensions: .{}.", path.string(),
       extension.empty() ? "no extension" : "extension '." + extension + "'", what,
       near.empty() ? "" : fmt::format("did you mean '.{}'? ", near), fmt::join(known, ", ."));
}

}  // namespace tafoni::io
