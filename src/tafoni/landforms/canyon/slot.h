#pragma once
// Slot canyons: a deep cleft, hardly wider than it must be, that winds on its way down so that its walls
// overhang now on this side and now on that.

#include <cstdint>
#include <vector>

#include "tafoni/field/tree.h"
#include "tafoni/landforms/canyon/streams.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

struct SlotSettings {
  double slot_depth = 0;  ///< below the bed, metres
  double slot_width = 0;  ///< metres
  double winding = 0.6;   ///< how far walls lean over, as a share of what the width allows
  double beta = 0.2;      ///< how much the hardest rock gives way
  std::uint64_t seed = 0;
};

/// Adds the points that open a slot along a course; returns its length, 0 where there is no room.
double carve_slot(field::CloudBuilder& cloud, const Ground& ground, const Streams::Course& course,
                  const SlotSettings& settings);

}  // namespace tafoni::landforms::impl
