#pragma once
// How a scalar grid is cut into chunks for meshing.
//
// A chunk's samples are taken as a block that reaches one sample beyond its voxels, for the gradients.

#include <utility>

#include "tafoni/surface/polygonize.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::surface::impl {

/// Which voxels a chunk has, and where its block lies.
class GridLayout {
 public:
  GridLayout(const volume::GridFrame& frame, Boundary boundary);

  struct Block {
    Vec3i origin;   ///< sample (0, 0, 0) of the block
    Vec3i samples;  ///< a side, at most 37
    Vec3i lo, hi;   ///< voxels of the block that are the chunk's, hi exclusive
  };
  Block block(Vec3i chunk) const;
  Vec3i chunks() const { return chunks_; }  ///< a side
  /// The chunks whose mesh depends on these samples: first and last, last before first for none.
  std::pair<Vec3i, Vec3i> touched(const volume::SampleBox& samples) const;
  /// The chunk that an edge of the lattice is counted to, by the sample it starts from.
  Vec3i owner(Vec3i sample) const;

  const volume::GridFrame frame;
  const Boundary boundary;
  const float margin;

 private:
  Vec3i chunks_;
};

}  // namespace tafoni::surface::impl
