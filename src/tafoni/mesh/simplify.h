#pragma once
// Simplification by quadric edge collapse (meshoptimizer), in patches, that keeps the mesh manifold.

#include <cstdint>
#include <functional>
#include <span>

#include "tafoni/core/progress.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh {

struct SimplifySettings {
  double error = 0.1;  ///< metres: greatest (quadric) distance from the given surface
  /// The open border is a seam to other meshes that are simplified by themselves: no edge and no triangle is
  /// made between its vertices, as the neighbour might make the same, and joined they would not be manifold.
  bool seams = false;
  /// Fills normals at local positions; null keeps those the remaining vertices have. Vertices never move,
  /// so kept normals stay right.
  std::function<void(std::span<const Vec3f> positions, std::span<Vec3f> normals)> normals;
};

struct SimplifyStats {
  std::uint64_t triangles_before = 0, triangles_after = 0;
  std::uint64_t patches = 0;
  std::uint64_t patches_rejected = 0;  ///< left as they were because a collapse broke the surface
};

/// Open borders (so the seams of tiles, too) stay as they are, vertex for vertex. The result is 2-manifold
/// if `mesh` is; with `seams`, so are tiles joined, if they were. Remaining vertices keep their order,
/// normals and colours. Does not depend on threads.
Mesh simplify(const Mesh& mesh, const SimplifySettings& settings, Progress& progress = silent(),
              SimplifyStats* stats = nullptr);

}  // namespace tafoni::mesh
