#pragma once
// The triangles of some bricks of a chunk, for those who need the surface near a place only.

#include <cstdint>
#include <memory>

#include "tafoni/field/chunks.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::surface {

/// Each thread has its own, whose memory is used again from call to call.
class BrickPolygonizer {
 public:
  /// `region`: what the mesh that this one shall equal is made of (its settings' region, or the field's
  /// bounds), since vertices keep a little further from lattice points where floats are coarse. Throws as
  /// polygonize() does.
  BrickPolygonizer(double voxel, const Box3d& region);
  ~BrickPolygonizer();
  BrickPolygonizer(const BrickPolygonizer&) = delete;
  BrickPolygonizer& operator=(const BrickPolygonizer&) = delete;

  /// Makes the triangles of the cells of the active bricks in `box`; positions are bit for bit those of
  /// polygonize(), and there are no normals. `out` is overwritten.
  void polygonize(const field::ChunkSamples& samples, const field::BrickBox& box, mesh::Mesh& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::surface
