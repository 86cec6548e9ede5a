#include "tafoni/io/mesh_file.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/reading.h"

namespace tafoni::io {

namespace {

/// What `form` is in a format.
MeshForm form_in(const FormatType& format, MeshForm form) {
  if (form.up == 0) form.up = format.ups.front();
  const auto lacks = [&](std::string_view what) {
    fail(ErrorKind::usage, "A {} file has no {}; choose another format.", format.about.name, what);
  };
  if (format.ups.find(form.up) == std::string::npos) lacks(fmt::format("{} up", form.up));
  if (form.world && !format.world) lacks("world coordinates");
  if (form.float_colors && !format.float_colors) lacks("colours as floats");
  return form;
}

}  // namespace

void write_mesh(const std::filesystem::path& path, const mesh::Mesh& mesh, const MeshMetadata& metadata,
                Progress& progress, const MeshForm& form) {
  const FormatType& format = format_of(path, Ability::write_mesh);
  const MeshForm laid = form_in(format, form);
  if (mesh.triangles.empty())
    fail(ErrorKind::output, "{}: the mesh has no triangles, so there is nothing to write.", path.string());
  AtomicFile file(path);
  progress.begin("writing " + path.filename().string(), mesh.positions.size() + mesh.triangles.size(),
                 "items");
  format.write_mesh(file, mesh, {metadata, laid}, progress);
  file.commit();
  progress.end();
}

mesh::Mesh read_mesh(const std::filesystem::path& path) {
  format_of(path, Ability::read_mesh);  // what is wrong with the name is told before what is with the file
  return read_mesh(impl::MappedFile(path).bytes(), path.string());
}

mesh::Mesh read_mesh(std::span<const std::byte> bytes, const std::string& name) {
  mesh::Mesh mesh = format_of(name, Ability::read_mesh).read_mesh(bytes, name);
  impl::check_read(mesh, name);
  return mesh;
}

}  // namespace tafoni::io
