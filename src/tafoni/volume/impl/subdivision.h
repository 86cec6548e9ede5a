#pragma once
// One level of midpoint subdivision, box by box.

#include <cstdint>

#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume::impl {

/// A lattice of samples, x fastest.
struct Lattice {
  const float* values;
  Vec3i size;
};

struct Subdivision {
  Lattice coarse;
  std::uint64_t key = 0;  ///< of seed and level
  float noise = 0;
  float limit = 0;  ///< values are kept within +-limit
};

/// Writes the samples of `box` of the lattice that is twice as fine; out's rows and planes are `row` and
/// `plane` floats apart.
void subdivide(const Subdivision& step, const SampleBox& box, float* out, std::size_t row, std::size_t plane);

/// Encloses what subdivide() writes, before limiting.
Interval subdivision_range(const Subdivision& step, const SampleBox& box);

}  // namespace tafoni::volume::impl
