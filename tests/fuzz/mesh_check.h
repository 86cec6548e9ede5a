#pragma once
// What every reader of meshes promises of any bytes: a sound mesh of a bounded size, or one error of kind
// input.

#include <cmath>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"

/// For mutate_main.cpp and as a first corpus.
std::vector<std::string> fuzz_seeds();

inline void check_mesh(std::span<const std::byte> bytes, const std::string& name) {
  using namespace tafoni;
  // A copy of the exact size lets AddressSanitizer see any step beyond it.
  const std::vector<std::byte> copy(bytes.begin(), bytes.end());
  mesh::Mesh mesh;
  try {
    mesh = io::read_mesh(copy, name);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) std::abort();
    return;
  }
  const auto full = [&](std::size_t n, std::size_t all) { return n == 0 || n == all; };
  const std::size_t vertices = mesh.positions.size();
  if (!full(mesh.normals.size(), vertices) || !full(mesh.colors.size(), vertices) ||
      !full(mesh.texture.size(), mesh.triangles.size()))
    std::abort();
  if (vertices + mesh.triangles.size() > 4 * copy.size() + (1u << 21)) std::abort();
  for (const Vec3f& p : mesh.positions)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
  const mesh::MeshReport report = mesh::validate(mesh);
  if (report.index_errors > 0 || report.bad_positions > 0 || report.bad_normals > 0) std::abort();
  if (mesh::metrics(mesh).triangles > mesh.triangles.size()) std::abort();
}
