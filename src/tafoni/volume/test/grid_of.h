#pragma once
// A scalar grid of a formula.

#include <functional>
#include <span>

#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {

/// Holds f at every sample of the frame.
inline ScalarGrid grid_of(const GridFrame& frame, const std::function<double(Vec3d)>& f) {
  ScalarGrid out(frame, -1);
  out.edit(out.samples(), [&](Vec3i first, std::span<float> row) {
    for (int i = 0; i < std::ssize(row); ++i)
      row[i] = static_cast<float>(f(frame.position(first + Vec3i{i, 0, 0})));
  });
  out.compact();
  return out;
}

}  // namespace tafoni::volume
