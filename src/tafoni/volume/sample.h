#pragma once
// Fields as grids: what a construction tree says, written down sample by sample.

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {

struct SampleSettings {
  Precision precision = Precision::single;
  /// Metres. Values are limited to +-band, so that only what is near the surface takes memory; 0 for values
  /// as they are.
  double band = 0;
  /// Whether those beyond the band that were worked out all the same are limited, too: without, a surface
  /// between steep values keeps its place.
  bool limit = true;
};

/// The smallest frame that covers `box` with samples on the lattice of `spacing`, which are those that a
/// mesher of that voxel size looks at. Throws Error{usage} for a box that is empty or unbounded, or too fine
/// a spacing.
GridFrame frame_over(const Box3d& box, double spacing);

/// Every sample is field.value() at its position, bit for bit, before limiting and rounding to half
/// precision; one beyond the band is at least on its side of it. Chunks over which the field's interval is
/// one value are not evaluated and take no memory. Memory: the result's, 128 KB a chunk that holds two values
/// (64 KB in half precision), and what 16 columns of 64 x 64 samples hold, in the making. The same at any
/// thread count.
ScalarGrid sample(const field::CompiledField& field, const GridFrame& frame,
                  const SampleSettings& settings = {}, Progress& progress = silent());

}  // namespace tafoni::volume
