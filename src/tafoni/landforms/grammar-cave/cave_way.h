#pragma once
// The way through a cave: room for a walker along it, and a floor of sediment that falls off beside it.

#include <cstdint>
#include <vector>

#include "tafoni/field/function.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms::impl {

/// A piece of the way, on the floor; local metres.
struct Stretch {
  Vec3d from, to;
  double width = 1.2;  ///< metres to each side over which the floor is level
  bool room = true;    ///< whether rock is taken out along it
};

struct WaySettings {
  double radius = 1.5;  ///< metres; of the room along the way
  double lift = 1.3;    ///< of the middle of that room over the floor
  double depth = 4;     ///< how thick the sediment is at most
  double bumps = 0.12;  ///< most that the floor rises or falls
  std::uint64_t seed = 0;
};

/// Elevation, at `p` in plan, of a stretch's floor without its bumps, and of the stretch where it is nearest.
struct FloorAt {
  double top, on;
};
FloorAt floor_at(const Stretch& stretch, Vec3d p);

/// The room: metres to its surface, positive inside.
field::FunctionPtr room_of(std::vector<Stretch> way, const WaySettings& settings);
/// The sediment: positive inside; beside the way its surface falls off at 14 degrees.
field::FunctionPtr floor_of(std::vector<Stretch> way, const WaySettings& settings);

/// Metres outside of a box, by axes, times `steep`; negative inside.
field::FunctionPtr outside_of(const Box3d& box, double steep);

}  // namespace tafoni::landforms::impl
