#pragma once
// The mesh of a scalar grid, chunk by chunk (chunk.h), kept up to date while the grid is edited ([Ruths01]:
// only touched voxels are polygonized again).
//
// Voxel (i, j, k) is the cell between the samples (i, j, k) and (i + 1, j + 1, k + 1); chunk (a, b, c) has
// the voxels from (32 a, 32 b, 32 c). Cases, vertices and normals are those of polygonize_grid(): normals are
// minus the central differences of the samples, one-sided at the frame, so that neighbours agree bit for bit.

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/surface/chunk.h"
#include "tafoni/surface/polygonize.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::surface {

/// Convex planar polygons, by voxel ([Ruths01]: collision on convex polygons). They cover the chunk's
/// triangles exactly: each is a union of triangles of one voxel whose corners lie within 1/256 of a voxel's
/// size of one plane. No other such union leaves fewer.
struct VoxelPolygons {
  std::vector<Vec3i> voxels;           ///< those that the surface cuts, ascending by (z, y, x)
  std::vector<std::uint32_t> first;    ///< first polygon of each voxel, and the number of polygons
  std::vector<std::uint32_t> begin;    ///< first corner of each polygon, and the number of corners
  std::vector<std::uint32_t> corners;  ///< vertices, counter-clockwise seen from the air

  std::size_t size() const { return begin.empty() ? 0 : begin.size() - 1; }
  std::span<const std::uint32_t> polygon(std::size_t p) const {
    return {corners.data() + begin[p], begin[p + 1] - begin[p]};
  }
  /// The polygons [first, second) of a voxel; none where the surface does not cut it.
  std::pair<std::uint32_t, std::uint32_t> of(Vec3i voxel) const;
};

/// Positions are local metres. Never changes: an update makes a new one, and who holds the old one may go on
/// reading it.
struct GridChunkMesh : ChunkMesh {
  VoxelPolygons polygons;  ///< where asked for
};
using GridChunkPtr = std::shared_ptr<const GridChunkMesh>;

struct GridMesherSettings {
  /// `solid`: a layer of air around the frame closes the surface with walls 1/128 of a voxel (or what floats
  /// need) outside of the frame; its voxels, one beyond the frame's, belong to the chunks beside them.
  Boundary boundary = Boundary::open;
  bool polygons = false;
};

/// A mesher is not for several threads at once, but works on several itself. Besides the meshes it holds 20
/// KB a chunk with surface, 25 KB with polygons.
class GridMesher {
 public:
  explicit GridMesher(const GridMesherSettings& settings = {});
  ~GridMesher();
  GridMesher(const GridMesher&) = delete;
  GridMesher& operator=(const GridMesher&) = delete;

  /// Keeps the contract of chunk.h. Outside of the boxes the grid's samples must be bit for bit those of the
  /// last update's; a grid of another frame is looked at everywhere.
  /// Throws Error{usage} for a frame too far from zero for floats. After an error or a cancel the next update
  /// looks at everything.
  std::vector<ChunkChange> update(const volume::ScalarGrid& grid, std::span<const volume::SampleBox> changed,
                                  Progress& progress = silent());

  /// The chunk's mesh: never null, and empty where there is no surface.
  GridChunkPtr chunk(Vec3i chunk) const;
  /// Every chunk with triangles, sorted.
  std::vector<Vec3i> chunks() const;
  /// All of them as one mesh without repeated vertices.
  mesh::Mesh assemble() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::surface
