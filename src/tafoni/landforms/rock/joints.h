#pragma once
// Joints: near-vertical planes of weakness in two directions, along which the sea opens clefts and caves.

#include <array>
#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni::landforms::impl {

class Joints {
 public:
  /// `spacing` is the mean distance between the joints of a set, `width` the half-width of the weak rock;
  /// both are metres.
  Joints(double spacing, double width, std::uint64_t seed);
  /// How much joints weaken the rock: 0 where it is sound, up to 1 in the middle of a joint.
  double weakness(Vec3d p) const;
  /// The unit direction of the set of joints that lies nearest to `wanted` (horizontal).
  Vec3d along(Vec3d wanted) const;

 private:
  struct Set {
    Vec3d across, along;
    std::uint64_t seed;
  };
  double weakness(const Set& set, Vec3d p) const;

  double spacing_, width_;
  std::array<Set, 2> sets_;
};

}  // namespace tafoni::landforms::impl
