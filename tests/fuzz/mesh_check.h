#pragma once
// What every reader of meshes promises of any bytes: a sound mesh of a bounded size, or one error of kind
// input.

#include "fuzz.h"

#include "tafoni/io/mesh_file.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"

inline void check_mesh(std::span<const std::byte> bytes, const std::string& name) {
  using namespace tafoni;
  // A copy of the exact size lets AddressSanitizer see any step beyond it.
  const std::vector<std::byte> copy(bytes.begin(), bytes.end());
  mesh::Mesh mesh;
  if (!accepts([&] { mesh = io::read_mesh(copy, name); })) return;
  const auto full = [&](std::size_t n, std::size_t all) { return n == 0 || n == all; };
  const std::size_t vertices = mesh.positions.size();
  require(full(mesh.normals.size(), vertices) && full(mesh.colors.size(), vertices) &&
          full(mesh.texture.size(), mesh.triangles.size()));
  require(vertices + mesh.triangles.size() <= 4 * copy.size() + (1u << 21));
  for (const Vec3f& p : mesh.positions)
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  const mesh::MeshReport report = mesh::validate(mesh);
  require(report.index_errors == 0 && report.bad_positions == 0 && report.bad_normals == 0);
  require(mesh::metrics(mesh).triangles <= mesh.triangles.size());
}
