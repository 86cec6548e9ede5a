#pragma once
// The shapes of arches: a window through a wall of rock, a shaft behind it, a bridge across a gap.

#include <memory>

#include "tafoni/landforms/rock/rock_shape.h"

namespace tafoni::landforms::impl {

/// An opening through a wall: broad floor, vaulted roof, wider at its mouths.
struct Window {
  Vec3d center;
  Vec3d through;                   ///< unit, horizontal
  double half_width, half_height;  ///< metres, of the clear opening in middling rock
  double half_length;              ///< along `through`, into the air on both sides
  /// A shaft to the sky at the inner end: its distance from the centre along `through`, its radius and its
  /// top; radius 0 for none.
  double shaft_at = 0, shaft_radius = 0, shaft_top = 0;

  Vec3d along() const { return {-through.y, through.x, 0}; }
};
/// A function that is positive in the opening.
std::shared_ptr<const RockShape> window_shape(const Window& window, const RockTexture& texture);
/// A box outside of which the opening's value is -T.
Box3d reach(const Window& window, double margin, double amplitude);

/// A rising span of rock, thicker and broader at its ends, which reach into the rock on both sides.
struct Bridge {
  Vec3d from, to;
  double rise;    ///< metres that the middle lies above the straight line
  double width;   ///< metres: half the breadth of the deck in the middle
  double depth;   ///< metres: half the thickness there
  double wander;  ///< metres that it strays from the straight line sideways, at most
};
/// A function that is positive in the rock of the bridge.
std::shared_ptr<const RockShape> bridge_shape(const Bridge& bridge, const RockTexture& texture);
Box3d reach(const Bridge& bridge, double margin, double amplitude);

}  // namespace tafoni::landforms::impl
