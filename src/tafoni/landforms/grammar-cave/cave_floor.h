#pragma once
// Where a walker can go in a cave: the floors of its parts, joined by slopes that can be walked.

#include <span>
#include <vector>

#include "tafoni/grammar/assembly.h"
#include "tafoni/landforms/grammar-cave/cave_way.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// Metres that are walked before the mouth.
inline constexpr double apron = 6;

/// The way in, from before the mouth through every part that can be reached on foot; local.
struct Way {
  std::vector<Stretch> stretches;
  std::vector<Vec3d> route;  ///< to the part that is farthest
};

/// Through `parts`, the first of which is the passage: `length` metres from the mouth at the frame's zero,
/// `width` metres of level floor to each side.
Way find_way(const Ground& ground, std::span<const grammar::Part> parts, const grammar::Pose& frame,
             double length, double width, const WaySettings& settings);

}  // namespace tafoni::landforms::impl
