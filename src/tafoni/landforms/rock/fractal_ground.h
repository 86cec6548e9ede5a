#pragma once
// A terrain made anew as a volume: 3D midpoint subdivision from the shape of the terrain that stands
// [Ju01 §2].

#include <cstdint>
#include <optional>
#include <vector>

#include "tafoni/landforms/site/ground.h"
#include "tafoni/volume/fractal.h"

namespace tafoni::landforms::impl {

struct FractalGroundSettings {
  double noise = 0.6;       ///< most that a new sample is off, as a share of its distance to the old ones
  double coarse = 0;        ///< metres between the given values, 0 for a quarter of the shorter side
  double spacing = 0;       ///< metres between the finest samples, at most; 0 for the site's own choice
  double decay = 0.5;       ///< what is left of the noise from level to level
  std::int64_t smooth = 2;  ///< last levels without noise
  bool detail = true;       ///< whether the terrain's own detail stays under the noise; else only its coarse
  ///< shape does
  /// Metres inside the region's border over which the volume takes over; 0 for a quarter of `coarse`.
  double fade = 0;
  std::vector<volume::Pin> pins;  ///< their radius decides the level
  std::uint64_t seed = 0;
};

struct FractalGround {
  field::FunctionPtr volume;  ///< over the whole site, before the region
  Result result;              ///< its reshape puts the volume in place; its facts tell of the lattice
};

FractalGround fractal_ground(const Ground& ground, const FractalGroundSettings& settings, Progress& progress);

/// A scalar grid as a leaf whose gradients do not jump from cell to cell, limited to +-T.
field::FunctionPtr volume_leaf(volume::ScalarGrid grid, double amplitude);

}  // namespace tafoni::landforms::impl
