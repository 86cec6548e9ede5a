#include "tafoni/io/format.h"

#include <algorithm>
#include <cctype>

#include <fmt/ranges.h>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/reading.h"

namespace tafoni::io {
namespace {

bool able(const FormatType& format, Ability ability) {
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
      return format.read_volume != nullptr;
  }
  return false;
}

std::vector<std::string> known_extensions(std::initializer_list<Ability> abilities) {
  std::vector<std::string> known;
  for (const FormatType* format : all_formats())
    if (std::ranges::any_of(abilities, [&](Ability ability) { return able(*format, ability); }))
      known.insert(known.end(), format->extensions.begin(), format->extensions.end());
  return known;
}

const FormatType* find(std::string_view extension, Ability ability) {
  for (const FormatType* format : all_formats())
    if (able(*format, ability) &&
        std::ranges::find(format->extensions, extension) != format->extensions.end())
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

void write_mesh(const std::filesystem::path& path, const mesh::Mesh& mesh, const MeshMetadata& metadata,
                Progress& progress) {
  const FormatType& format = format_of(path, Ability::write_mesh);
  if (mesh.triangles.empty())
    fail(ErrorKind::output, "{}: the mesh has no triangles, so there is nothing to write.", path.string());
  AtomicFile file(path);
  progress.begin("writing " + path.filename().string(), mesh.positions.size() + mesh.triangles.size(),
                 "items");
  format.write_mesh(file, mesh, metadata, progress);
  file.commit();
  progress.end();
}

mesh::Mesh read_mesh(const std::filesystem::path& path) {
  const FormatType& format = format_of(path, Ability::read_mesh);
  const impl::MappedFile file(path);
  mesh::Mesh mesh = format.read_mesh(file.bytes(), path.string());
  impl::check_read(mesh, path.string());
  return mesh;
}

void write_image(const std::filesystem::path& path, const raster::Image& image) {
  const FormatType& format = format_of(path, Ability::write_image);
  if (image.empty())
    fail(ErrorKind::output, "{}: the picture has no pixels, so there is nothing to write.", path.string());
  AtomicFile file(path);
  format.write_image(file, image);
  file.commit();
}

void write_volume(const std::filesystem::path& path, const Volume& volume, Progress& progress) {
  const FormatType& format = format_of(path, Ability::write_volume);
  AtomicFile file(path);
  const Vec3i chunks = volume.grid.chunks();
  progress.begin("writing " + path.filename().string(),
                 static_cast<std::uint64_t>(std::int64_t{chunks.x} * chunks.y * chunks.z), "chunks");
  format.write_volume(file, volume, progress);
  file.commit();
  progress.end();
}

Volume read_volume(const std::filesystem::path& path, Progress& progress) {
  const FormatType& format = format_of(path, Ability::read_volume);
  const impl::MappedFile file(path);
  return format.read_volume(file.bytes(), path.string(), progress);
}

}  // namespace tafoni::io
