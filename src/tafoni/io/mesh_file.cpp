#include "tafoni/io/mesh_file.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/reading.h"

namespace tafoni::io {

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

}  // namespace tafoni::io
