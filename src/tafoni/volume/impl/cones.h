#pragma once
// Samples about the segments of tunnels.

#include <span>

#include "tafoni/math/vec.h"

namespace tafoni::volume::impl {

/// Of a tunnel without a level floor.
inline constexpr double round_floor = 1e9;
/// Beyond a cone's ends its floor rises by so much a metre: more than floors that are walked, or each would
/// dig a step into the next one.
inline constexpr double floor_ramp = 0.65;

/// A rounded cone: spheres of radius + grow * s about the points `from` + s `along`, 0 <= s <= length.
struct Cone {
  Vec3d from, along;  ///< local metres; unit
  double length = 0, radius = 1, grow = 0;
  double floor = round_floor;  ///< metres below the axis

  double value(Vec3d p) const;  ///< distance to the wall, negative inside; cut by the floor
  double round(Vec3d p) const;  ///< the same without the floor: no more than it
};
/// Of the two spheres' ends; where one holds the other, that one alone.
Cone cone_between(Vec3d a, double radius_a, Vec3d b, double radius_b, double floor);

inline constexpr int brick_side = 8;
/// out[(z * 8 + y) * 8 + x]: the least value of the cones at first + spacing * (x, y, z); at least one cone.
void least_values(std::span<const Cone* const> cones, Vec3d first, double spacing, float* out);

}  // namespace tafoni::volume::impl
