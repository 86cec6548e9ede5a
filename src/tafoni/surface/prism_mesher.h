#pragma once
// The surface of a prism-field [Boggus §3, fig. 6]: tops and bottoms as heightfields of
// two triangles a cell, closed by upright walls. What connects is said in volume/inner/prism_cells.h.
//
// Rims follow the columns, in teeth. Moving their vertices to where tops and bottoms would meet was thought
// through: it helps where matter thins out, but teeth show where walls are upright, and there columns do not
// tell where the wall is. The leaf can be rounded instead (volume/prism_convert.h).

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/chunks.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/surface/chunk.h"
#include "tafoni/volume/prism_field.h"

namespace tafoni::surface {

/// [Boggus] textures each on its own.
enum class PrismSurface : std::uint8_t { upper, lower, middle };

struct PrismMeshSettings {
  volume::DeadPoints dead = volume::DeadPoints::triangles;
  /// Linear RGBA of upper, lower and middle surface.
  std::array<std::array<std::uint8_t, 4>, 3> colors{
      {{96, 110, 54, 255}, {92, 70, 50, 255}, {150, 118, 84, 255}}};
};

/// The whole closed surface, oriented outward and 2-manifold: matter that touches itself only along an edge
/// or at a corner is separate there. Positions are relative to the frame's origin, which is in mesh.origin
/// (local metres). A vertex has the area-weighted mean of its triangles' normals and the mean of their
/// colours. `surfaces`, if given, gets one a triangle.
mesh::Mesh polygonize(const volume::PrismFields& fields, const PrismMeshSettings& settings = {},
                      std::vector<PrismSurface>* surfaces = nullptr);

/// A chunk (chunk.h) for drawing: vertices are not shared between upper, lower and middle surface, so that
/// edges stay sharp. Positions are relative to the frame's origin.
struct PrismChunkMesh : ChunkMesh {
  std::vector<PrismSurface> surfaces;  ///< one a vertex
};

/// The mesh of a prism-field, kept up to date by chunks while it is dug. Chunk (a, b, 0) has the cells from
/// (16 a, 16 b). A mesher works on several threads, but is not for several at once.
class PrismMesher {
 public:
  static constexpr int chunk_cells = 16;

  explicit PrismMesher(const PrismMeshSettings& settings = {});
  ~PrismMesher();
  PrismMesher(PrismMesher&&) noexcept;
  PrismMesher& operator=(PrismMesher&&) noexcept;

  /// Keeps the contract of chunk.h; `changed`: the columns that differ from the last update's. A frame that
  /// changed throws Error{usage}.
  std::vector<ChunkChange> update(const volume::PrismFields& fields, const volume::ColumnBox& changed);

  int chunks_x() const;
  int chunks_y() const;
  /// The chunk's mesh; empty where there is no surface. Valid until the next update().
  const PrismChunkMesh& chunk(Vec3i chunk) const;
  /// Every chunk with triangles, sorted.
  std::vector<Vec3i> chunks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::surface
