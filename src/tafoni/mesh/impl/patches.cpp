#include "tafoni/mesh/impl/patches.h"

#include <algorithm>
#include <cmath>

#include <meshoptimizer.h>

namespace tafoni::mesh::impl {

std::vector<Patch> cut(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                       std::size_t wanted, double shift) {
  Box3f box;
  for (const Vec3f& p : positions) box.expand(p);
  const double count = std::max(1.0, static_cast<double>(triangles.size()) / static_cast<double>(wanted));
  const double width = static_cast<double>(box.size().x), depth = static_cast<double>(box.size().y);
  const double side = std::max({std::sqrt(width * depth / count), width / 1000, depth / 1000, 1e-6});
  const auto columns = static_cast<std::size_t>(width / side + 2),
             rows = static_cast<std::size_t>(depth / side + 2);
  std::vector<Patch> patches(columns * rows);
  for (const Triangle& t : triangles) {
    // A corner places the triangle as well as its middle does.
    const Vec3f p = positions[t[0]];
    const auto column = static_cast<std::size_t>(static_cast<double>(p.x - box.lo.x) / side + shift);
    const auto row = static_cast<std::size_t>(static_cast<double>(p.y - box.lo.y) / side + shift);
    patches[std::min(row, rows - 1) * columns + std::min(column, columns - 1)].given.push_back(t);
  }
  std::erase_if(patches, [](const Patch& p) { return p.given.empty(); });
  return patches;
}

void collapse(std::span<const Vec3f> positions, Patch& patch, double error) {
  std::vector<std::uint32_t> used;
  used.reserve(3 * patch.given.size());
  for (const Triangle& t : patch.given) used.insert(used.end(), t.begin(), t.end());
  std::vector<std::uint32_t> indices = used;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<Vec3f> local(used.size());
  for (std::size_t v = 0; v < used.size(); ++v) local[v] = positions[used[v]] - positions[used[0]];
  for (auto& i : indices)
    i = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), i) - used.begin());
  const float scale = meshopt_simplifyScale(&local[0].x, local.size(), sizeof(Vec3f));
  std::vector<std::uint32_t> out(indices.size());
  const std::size_t left =
      scale > 0 ? meshopt_simplify(out.data(), indices.data(), indices.size(), &local[0].x, local.size(),
                                   sizeof(Vec3f), 0, static_cast<float>(error) / scale,
                                   meshopt_SimplifyLockBorder, nullptr)
                : 0;
  patch.result.clear();
  for (std::size_t i = 0; i < left; i += 3) patch.result.push_back({out[i], out[i + 1], out[i + 2]});
  flip_flat_triangles(local, patch.result);
  for (Triangle& t : patch.result)
    for (auto& v : t) v = used[v];
}

std::vector<bool> broken_vertices(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  std::vector<bool> broken(positions.size(), false);
  for (const Triangle& t : triangles) {
    const Vec3d a = to_double(positions[t[0]]), b = to_double(positions[t[1]]),
                c = to_double(positions[t[2]]);
    if (cross(b - a, c - a) == Vec3d{})
      for (auto v : t) broken[v] = true;
  }
  for_each_edge(triangles, positions.size(),
                [&](std::uint32_t a, std::uint32_t b, std::uint32_t forward, std::uint32_t backward) {
                  if (forward > 1 || backward > 1) broken[a] = broken[b] = true;
                });
  // With clean edges a vertex is clean when its triangles hang together; two equal triangles share three
  // edges.
  const Incidence around = incidence(triangles, positions.size());
  FanCounter fans;
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (!around.at(v).empty() && fans.count(triangles, around.at(v), v) > 1) broken[v] = true;
  return broken;
}

}  // namespace tafoni::mesh::impl
