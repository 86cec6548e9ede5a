// Checks triangles one by one, then edges (each found once by its lower vertex), then vertices: the triangles
// around a sound one form a single fan. Each check counts what is wrong and goes on.

#include "tafoni/mesh/validate.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tafoni/mesh/inner/topology.h"

namespace tafoni::mesh {
namespace {

using inner::Triangle;

bool finite(Vec3f p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

struct Corners {
  Vec3d a, b, c;
};
Corners corners(const Mesh& mesh, const Triangle& t) {
  return {to_double(mesh.positions[t[0]]), to_double(mesh.positions[t[1]]), to_double(mesh.positions[t[2]])};
}

/// sin(1 degree) against the two longest sides: the smallest angle lies between them.
bool sliver(const Corners& t, double twice_area) {
  double sides[] = {length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)};
  std::sort(sides, sides + 3);
  return twice_area < 0.0174524 * sides[1] * sides[2];
}

void check_triangles(const Mesh& mesh, MeshReport& report, std::vector<Triangle>& sound) {
  for (const Triangle& t : mesh.triangles) {
    if (std::max({t[0], t[1], t[2]}) >= mesh.positions.size()) {
      ++report.index_errors;
      continue;
    }
    if (inner::repeats_vertex(t)) {
      ++report.degenerate_triangles;
      continue;
    }
    sound.push_back(t);
    const Corners c = corners(mesh, t);
    const double twice_area = length(cross(c.b - c.a, c.c - c.a));
    if (twice_area == 0)
      ++report.degenerate_triangles;
    else if (sliver(c, twice_area))
      ++report.slivers;
  }
}

void check_edges(const std::vector<Triangle>& triangles, std::size_t vertices, MeshReport& report) {
  inner::for_each_edge(triangles, vertices,
                       [&](std::uint32_t, std::uint32_t, std::uint32_t forward, std::uint32_t backward) {
                         if (forward + backward == 1) ++report.boundary_edges;
                         if (forward + backward > 2) ++report.non_manifold_edges;
                         if (forward + backward == 2 && forward != 1) ++report.orientation_conflicts;
                       });
}

void check_vertices(const Mesh& mesh, const std::vector<Triangle>& triangles, MeshReport& report) {
  const inner::Incidence around = inner::incidence(triangles, mesh.positions.size());
  inner::FanCounter fans;
  std::vector<Triangle> keys;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const std::span<const std::uint32_t> here = around.at(v);
    if (here.empty()) {
      ++report.unused_vertices;
      continue;
    }
    if (fans.count(triangles, here, v) > 1) ++report.non_manifold_vertices;
    // Each triangle is compared once, at its lowest vertex.
    keys.clear();
    for (auto i : here) {
      Triangle key = triangles[i];
      std::sort(key.begin(), key.end());
      if (key[0] == v) keys.push_back(key);
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t i = 1; i < keys.size(); ++i) report.duplicate_triangles += keys[i] == keys[i - 1];
  }
}

void check_normals(const Mesh& mesh, const std::vector<Triangle>& triangles, MeshReport& report) {
  if (mesh.normals.empty()) return;
  if (mesh.normals.size() != mesh.positions.size()) {
    report.bad_normals = mesh.positions.size();
    return;
  }
  for (const Vec3f& n : mesh.normals)
    if (!finite(n) || std::abs(length(n) - 1.0f) > 1e-3f) ++report.bad_normals;
  for (const Triangle& t : triangles) {
    const Corners c = corners(mesh, t);
    Vec3d mean;
    for (auto v : t) mean += to_double(mesh.normals[v]);
    report.flipped_normals += dot(cross(c.b - c.a, c.c - c.a), mean) < 0;
  }
}

}  // namespace

MeshReport validate(const Mesh& mesh) {
  MeshReport report;
  report.vertices = mesh.positions.size();
  report.triangles = mesh.triangles.size();
  for (const Vec3f& p : mesh.positions) report.bad_positions += !finite(p);
  std::vector<Triangle> sound;
  sound.reserve(mesh.triangles.size());
  check_triangles(mesh, report, sound);
  check_edges(sound, mesh.positions.size(), report);
  check_vertices(mesh, sound, report);
  check_normals(mesh, sound, report);
  inner::Sets sets(mesh.positions.size());
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : sound) {
    sets.join(t[0], t[1]);
    sets.join(t[1], t[2]);
    used[t[0]] = used[t[1]] = used[t[2]] = true;
  }
  for (std::uint32_t v = 0; v < used.size(); ++v) report.components += used[v] && sets.root(v) == v;
  return report;
}

std::vector<std::string> defects(const MeshReport& r) {
  const std::pair<std::uint64_t, const char*> lines[] = {
      {r.index_errors, "triangles name a vertex that is not there"},
      {r.bad_positions, "vertices have a position that is not a number"},
      {r.degenerate_triangles, "triangles have no area"},
      {r.duplicate_triangles, "triangles repeat another"},
      {r.non_manifold_edges, "edges belong to more than two triangles"},
      {r.non_manifold_vertices, "vertices join pieces that do not share an edge"},
      {r.orientation_conflicts, "edges lie between triangles of opposite orientation"},
      {r.unused_vertices, "vertices belong to no triangle"},
      {r.bad_normals, "normals are missing or not of unit length"},
  };
  std::vector<std::string> out;
  for (const auto& [count, text] : lines)
    if (count) out.push_back(fmt::format("{} {}", count, text));
  return out;
}

}  // namespace tafoni::mesh
