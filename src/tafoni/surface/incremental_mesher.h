#pragma once
// The mesh of one region of one lattice, kept up to date while its field is edited: what an edit does not
// touch is not looked at again.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tafoni/surface/chunk.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::surface {

/// Chunks (chunk.h) have field::chunk_cells cells a side; their positions are local metres. Pieces of surface
/// that assemble() removes for being small are still in them. Their normals are those of assemble(), but on a
/// chunk's border the field's alone, so that an edit changes no neighbour that it does not touch.
///
/// A mesher is not for several threads at once, but works on several itself. It holds about 52 bytes a vertex
/// and triangle and 70 KB a chunk with surface, no samples.
class IncrementalMesher {
 public:
  /// Throws as polygonize() does. Tiles are not used.
  explicit IncrementalMesher(const PolygonizeSettings& settings);
  ~IncrementalMesher();
  IncrementalMesher(const IncrementalMesher&) = delete;
  IncrementalMesher& operator=(const IncrementalMesher&) = delete;

  /// Keeps the contract of chunk.h. Outside of the boxes (local metres, closed) values and gradients of `now`
  /// must be bit for bit those of the last update's field. After an error or a cancel the next update looks
  /// at everything.
  std::vector<ChunkChange> update(const field::CompiledField& now, std::span<const Box3d> changed,
                                  Progress& progress = silent());

  /// The chunk's mesh; empty where there is no surface. Valid until the next update().
  ChunkView chunk(Vec3i chunk) const;
  /// Every chunk with triangles, sorted.
  std::vector<Vec3i> chunks() const;

  /// One mesh, byte for byte what polygonize() makes of the last update's field with the same settings.
  mesh::Mesh assemble();

  /// What the last update did.
  struct Stats {
    std::uint64_t chunks = 0;     ///< looked at
    std::uint64_t evaluated = 0;  ///< samples
    std::uint64_t vertices = 0;   ///< that were not taken over
  };
  const Stats& stats() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::surface
