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

/// The surface of 16 x 16 cells, for drawing: vertices are not shared between upper, lower and middle
/// surface, so that edges stay sharp. Positions and normals on its borders are repeated in the chunks beside
/// it, bit for bit.
struct PrismChunk {
  std::vector<Vec3f> positions;  ///< relative to the frame's origin
  std::vector<Vec3f> normals;
  std::vector<PrismSurface> surfaces;  ///< one a vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint64_t version = 0;  ///< of the update that made it
};

/// The mesh of a prism-field, kept up to date by chunks while it is dug. Chunks without a change are not
/// looked at. Works on several threads; not for several at once.
class PrismMesher {
 public:
  static constexpr int chunk_cells = 16;

  explicit PrismMesher(const PrismMeshSettings& settings = {});
  ~PrismMesher();
  PrismMesher(PrismMesher&&) noexcept;
  PrismMesher& operator=(PrismMesher&&) noexcept;

  struct ChunkIndex {
    int a = 0, b = 0;  ///< holds the cells from (16 a, 16 b)
    friend bool operator==(ChunkIndex, ChunkIndex) = default;
  };
  /// Meshes the chunks that the columns `changed` since the last update touch; the first one meshes all.
  /// Returns them, sorted by b, then a. A frame that changed throws Error{usage}.
  std::vector<ChunkIndex> update(const volume::PrismFields& fields, const volume::ColumnBox& changed);

  int chunks_x() const;
  int chunks_y() const;
  const PrismChunk& chunk(ChunkIndex at) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::surface
