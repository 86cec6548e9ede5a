// Measures a mesh in two passes: over the triangles for area, volume and what hangs together, and over the
// edges, each found once by its lower vertex, for lengths and for the loops that edges of one triangle form.

#include "tafoni/mesh/metrics.h"

#include <algorithm>
#include <cmath>

#include "tafoni/mesh/inner/topology.h"

namespace tafoni::mesh {
namespace {

using inner::Triangle;

std::vector<Triangle> sound_triangles(const Mesh& mesh) {
  std::vector<Triangle> out;
  out.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    if (std::max({t[0], t[1], t[2]}) < mesh.positions.size() && !inner::repeats_vertex(t)) out.push_back(t);
  return out;
}

void measure_edges(const Mesh& mesh, const std::vector<Triangle>& triangles, MeshMetrics& out) {
  inner::Sets rims(mesh.positions.size());
  std::vector<bool> on_rim(mesh.positions.size(), false);
  double sum = 0;
  inner::for_each_edge(triangles, mesh.positions.size(),
                       [&](std::uint32_t a, std::uint32_t b, std::uint32_t forward, std::uint32_t backward) {
                         const double l = length(to_double(mesh.positions[a]) - to_double(mesh.positions[b]));
                         out.shortest_edge = out.edges == 0 ? l : std::min(out.shortest_edge, l);
                         out.longest_edge = std::max(out.longest_edge, l);
                         sum += l;
                         ++out.edges;
                         if (forward + backward != 1) return;
                         on_rim[a] = on_rim[b] = true;
                         rims.join(a, b);
                       });
  if (out.edges) out.mean_edge = sum / static_cast<double>(out.edges);
  for (std::uint32_t v = 0; v < on_rim.size(); ++v) out.boundary_loops += on_rim[v] && rims.root(v) == v;
  out.closed = out.edges > 0 && out.boundary_loops == 0;
}

}  // namespace

MeshMetrics metrics(const Mesh& mesh) {
  MeshMetrics out;
  const std::vector<Triangle> triangles = sound_triangles(mesh);
  out.triangles = triangles.size();
  inner::Sets sets(mesh.positions.size());
  std::vector<bool> used(mesh.positions.size(), false);
  // About the middle of the mesh, or the volume of a small solid far from zero would drown in rounding.
  Box3d box;
  for (const Vec3f& p : mesh.positions) box.expand(to_double(p));
  const Vec3d middle = box.empty() ? Vec3d{} : box.center();
  for (const Triangle& t : triangles) {
    Vec3d p[3];
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = to_double(mesh.positions[t[c]]);
      out.bounds.expand(p[c] + mesh.origin);
      p[c] -= middle;
      used[t[c]] = true;
    }
    out.area += length(cross(p[1] - p[0], p[2] - p[0])) / 2;
    out.volume += dot(p[0], cross(p[1], p[2])) / 6;
    sets.join(t[0], t[1]);
    sets.join(t[1], t[2]);
  }
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    out.vertices += used[v];
    out.components += used[v] && sets.root(v) == v;
  }
  measure_edges(mesh, triangles, out);
  const std::int64_t v = out.vertices, e = out.edges, f = out.triangles;
  out.euler = v - e + f;
  out.genus = (2.0 * static_cast<double>(out.components) - static_cast<double>(out.boundary_loops) -
               static_cast<double>(out.euler)) /
              2;
  return out;
}

std::vector<std::uint32_t> vertex_components(const Mesh& mesh, std::uint32_t* count) {
  const std::size_t n = mesh.positions.size();
  inner::Sets sets(n);
  for (const Triangle& t : mesh.triangles)
    if (std::max({t[0], t[1], t[2]}) < n) sets.join(t[0], t[1]), sets.join(t[1], t[2]);
  std::vector<std::uint32_t> out(n);
  std::uint32_t components = 0;
  for (std::uint32_t v = 0; v < n; ++v) out[v] = sets.root(v) == v ? components++ : out[sets.root(v)];
  if (count) *count = components;
  return out;
}

}  // namespace tafoni::mesh
