#pragma once
// Where a cave opens on a hillside.

#include <optional>

#include "tafoni/core/progress.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

struct CaveMouth {
  Vec3d at;      ///< local, on the ground
  Vec3d inward;  ///< level, unit
};

struct MouthSettings {
  double rise = 8;     ///< metres: how far the ground shall rise above the mouth ...
  double within = 15;  ///< ... within this many metres
  double apron = 6;    ///< metres of ground before it that can be walked
  double slope = 0.5;  ///< steepest of that ground, as a tangent
};

/// The place of the whole site where the ground before is most level and the hillside behind rises fastest;
/// none where it nowhere rises enough.
std::optional<CaveMouth> find_mouth(const Ground& ground, const MouthSettings& settings, Progress& progress);
/// The best direction at a given place, whatever the ground.
CaveMouth mouth_at(const Ground& ground, Vec2d at, const MouthSettings& settings);

}  // namespace tafoni::landforms::impl
