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
/// Positive in the opening.
std::shared_ptr<const RockShape> window_shape(const Window& window, const RockTexture& texture);
/// Outside of it the opening's value is -T.
Box3d reach(const Window& window, double margin, double amplitude);

/// A rising span of rock, thicker and broader at its ends, which reach into the rock on both sides.
struct Bridge {
  Vec3d from, to;
  double rise;    ///< of the middle above the straight line, metres
  double width;   ///< half the breadth of the deck in the middle, metres
  double depth;   ///< half the thickness there, metres
  double wander;  ///< most that it strays from the straight line sideways, metres
};
/// Positive in the rock of the bridge.
std::shared_ptr<const RockShape> bridge_shape(const Bridge& bridge, const RockTexture& texture);
Box3d reach(const Bridge& bridge, double margin, double amplitude);

}  // namespace tafoni::landforms::impl
