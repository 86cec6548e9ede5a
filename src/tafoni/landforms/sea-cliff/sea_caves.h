#pragma once
// Sea caves and arches: the sea works its way into a cliff at its weakest places, along joints.

#include <cstdint>
#include <vector>

#include "tafoni/field/compiled.h"
#include "tafoni/landforms/rock/joints.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/surface.h"

namespace tafoni::landforms::impl {

/// A place of the cliff and how strongly it is attacked there, e in [0, 1].
struct Attack {
  SurfaceSample at;
  double effect;
};

struct CaveSettings {
  double cave_spacing = 45;  ///< metres between mouths, at least
  double cave_length = 25;   ///< metres, of a cave where rock is weakest
  double cave_radius = 2.5;  ///< metres, of the open passage
  double joints = 0.7;       ///< share by which a joint weakens the rock
  double sea_z = 0;          ///< local, metres
  std::uint64_t seed = 0;
};

struct CaveTube {
  Vec3d from, to;
  double radius;  ///< open, metres
};

struct SeaCaves {
  std::vector<CaveTube> tubes;
  std::vector<Vec3d> mouths;
  int arches = 0;     ///< those that come out on the other side of a headland
  double length = 0;  ///< metres of passage
};

/// Caves that start at the most strongly attacked places and follow the least resistance inward. `field` is
/// the notched cliff.
SeaCaves sea_caves(const field::CompiledField& field, const Ground& ground, const Joints& joints,
                   std::vector<Attack> attacks, const CaveSettings& settings, Progress& progress);

}  // namespace tafoni::landforms::impl
