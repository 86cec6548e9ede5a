#pragma once
// Small terrains for tests, and how two of them are compared.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "tafoni/runtime/destructible_terrain.h"

namespace tafoni::runtime {

inline constexpr Vec3d far_away{512345, 4456789, 1024};

/// 48 m of hills at 0.5 m, with a local zero in the middle.
inline DestructibleTerrain hills(DestructibleTerrainSettings settings,
                                 volume::Precision precision = volume::Precision::single, Vec3d origin = {}) {
  volume::ScalarGrid grid({{-24, -24, -16}, 0.5, {97, 97, 57}}, 0, precision);
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Vec3d p = grid.frame().position(first + Vec3i{static_cast<int>(i), 0, 0});
      row[i] = static_cast<float>(2 * std::sin(0.3 * p.x) * std::cos(0.21 * p.y) - p.z);
    }
  });
  if (settings.band == 0) settings.band = 2;
  return DestructibleTerrain(std::move(grid), origin, settings);
}

inline Box3d world_box(const DestructibleTerrain& terrain) {
  const SnapshotPtr now = terrain.snapshot();
  const Box3d box = now->grid().frame().box();
  return {now->to_world(box.lo), now->to_world(box.hi)};
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool same(const surface::GridChunkMesh& a, const surface::GridChunkMesh& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.normals, b.normals) &&
         same_bytes(a.triangles, b.triangles) && same_bytes(a.polygons.voxels, b.polygons.voxels) &&
         same_bytes(a.polygons.first, b.polygons.first) && same_bytes(a.polygons.begin, b.polygons.begin) &&
         same_bytes(a.polygons.corners, b.polygons.corners);
}

inline std::vector<Vec3i> names(const std::vector<surface::ChunkChange>& changes) {
  std::vector<Vec3i> out;
  for (const surface::ChunkChange& change : changes) out.push_back(change.chunk);
  return out;
}

/// The chunks whose mesh is not the same in both, sorted as snapshots sort them.
inline std::vector<Vec3i> differing(const Snapshot& a, const Snapshot& b) {
  std::vector<Vec3i> out;
  const Vec3i n = a.grid().chunks();
  for (int y = 0; y < n.y; ++y)
    for (int x = 0; x < n.x; ++x)
      for (int z = 0; z < n.z; ++z)
        if (!same(*a.chunk({x, y, z}).mesh, *b.chunk({x, y, z}).mesh)) out.push_back({x, y, z});
  return out;
}

}  // namespace tafoni::runtime
