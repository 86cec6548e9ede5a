#pragma once
// Where karst begins and ends: the places at which water enters the rock, and those at which it shall come to
// light again.

#include <cstdint>
#include <vector>

#include "tafoni/field/compiled.h"
#include "tafoni/landforms/karst/size.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// Parameters of karst.
struct EntranceSettings {
  std::int64_t sinks = 8, faces = 6;  ///< most of either kind
  double sink_depth = 0.3;            ///< metres; a shallower depression swallows no water
  double face_slope = 30;             ///< degrees from which ground is a face
  std::vector<double> springs;        ///< world x, y, z of each
};

/// All lie on the surface.
struct Entrances {
  std::vector<Vec3d> seeds;    ///< where a network begins: the user's points, then sinks, then faces
  std::vector<Vec3d> springs;  ///< where one shall end
};

/// Sinks are closed depressions, the largest first, then the softest gentle ground; faces are steep ground
/// before enough rock, the softest first. None that is chosen lies near another, nor below `lowest` (local
/// metres), where no room is left to descend into. Throws Error{usage} for springs that are not whole places.
Entrances choose_entrances(const field::CompiledField& field, const Ground& ground, const CaveSize& size,
                           double lowest, const EntranceSettings& settings, Progress& progress);

}  // namespace tafoni::landforms::impl
