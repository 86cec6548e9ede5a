#pragma once
// Marching cubes over the chunks of the lattice [Paris19 §7], with shared vertices.
//
// The result is 2-manifold, oriented outward and free of degenerate triangles whatever the samples are: the
// case table separates solid corners on ambiguous faces, and no diagonal of a triangulated loop lies in a
// cell's face. f = 0 counts as air. A vertex lies on a lattice edge, at 1/128 of the edge from its ends or
// further, so that float positions stay distinct. Output is ordered by chunk and inside a chunk by row;
// it does not depend on threads or tiles.

#include <cstdint>
#include <functional>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/surface/sample_source.h"

namespace tafoni::surface {

enum class Boundary {
  open,   ///< the surface inside the region only; ends there in a clean border of lattice faces
  solid,  ///< the whole closed surface; the field itself must be air at the region's border
};

struct PolygonizeSettings {
  double voxel = 1.0;  ///< size of a cell, metres
  Boundary boundary = Boundary::solid;
  /// Local metres. `open` keeps the cells whose centre lies in it; `solid` every chunk that touches it, so
  /// that a region that holds the whole surface loses nothing. It may have no end upward and downward. Empty:
  /// the columns over the field's bounds. Functions whose support has no end are not looked for beside these
  /// bounds, only above and below.
  Box3d region;
  /// `open` only: columns of cells whose centre (x, y), local metres, fails this are left out. May be null.
  /// Called from one thread. A column that would touch the kept ones only across a corner is left out too.
  std::function<bool(double, double)> inside;
  int tiles_x = 1, tiles_y = 1;  ///< how the work is split; polygonize() gives the same bytes for any
  /// Cubic metres. A closed piece of surface that encloses less is removed: a floating fragment, or a
  /// bubble inside the solid. 0 keeps all.
  double min_fragment_volume = 0;
  /// Minus the field's gradient, unit length. Where the triangles around a vertex face elsewhere by more than
  /// 37 degrees, along a crease or where the field is finer than a cell: their mean.
  bool normals = true;
};

struct PolygonizeStats {
  std::uint64_t chunks = 0;     ///< that hold surface
  std::uint64_t bricks = 0;     ///< active
  std::uint64_t cells = 0;      ///< cut by the surface
  std::uint64_t evaluated = 0;  ///< samples
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t components = 0;         ///< of the surface, before removal
  std::uint64_t fragments_removed = 0;  ///< floating pieces
  std::uint64_t bubbles_removed = 0;    ///< closed voids
  // Thread seconds, summed over threads; the last two are wall time.
  double evaluate_seconds = 0, triangles_seconds = 0, normals_seconds = 0, stitch_seconds = 0,
         gather_seconds = 0;
};

/// One mesh, its vertices shared across chunks. Positions are local (origin is left zero).
/// Throws Error{usage} for a voxel too small for the region: more than 2^30 cells from the origin, or
/// positions that float cannot tell apart.
mesh::Mesh polygonize(const field::CompiledField& field, const PolygonizeSettings& settings,
                      Progress& progress = silent(), PolygonizeStats* stats = nullptr);
mesh::Mesh polygonize(const SourceFactory& source, const Box3d& bounds, const PolygonizeSettings& settings,
                      Progress& progress = silent(), PolygonizeStats* stats = nullptr);

struct TileIndex {
  int x = 0, y = 0;  ///< x from the west, y from the south, below tiles_x and tiles_y
  friend bool operator==(TileIndex, TileIndex) = default;
};
using TileSink = std::function<void(TileIndex, mesh::Mesh&&)>;

/// The same triangles, one mesh a tile (a rectangle of chunk columns), handed to `sink` from the calling
/// thread, row by row; empty tiles are left out. Vertices on a seam are repeated in each tile that uses
/// them, bit for bit. Holds one tile at a time. Removing fragments and normals need a first pass over the
/// whole surface, since what is connected is decided over all tiles, and a normal on a seam depends on the
/// triangles beyond it; it costs a second evaluation.
void polygonize_tiles(const field::CompiledField& field, const PolygonizeSettings& settings,
                      const TileSink& sink, Progress& progress = silent(), PolygonizeStats* stats = nullptr);
void polygonize_tiles(const SourceFactory& source, const Box3d& bounds, const PolygonizeSettings& settings,
                      const TileSink& sink, Progress& progress = silent(), PolygonizeStats* stats = nullptr);

}  // namespace tafoni::surface
