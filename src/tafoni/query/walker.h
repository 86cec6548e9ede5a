#pragma once
// A walker: an upright capsule with gravity that climbs steps and gentle slopes and never enters the rock.

#include <numbers>
#include <optional>

#include "tafoni/query/collider.h"

namespace tafoni::query {

struct WalkerSettings {
  double radius = 0.35, height = 1.8;          ///< metres; the height is the whole capsule's
  double step = 0.45;                          ///< metres: the highest step that it climbs and goes down
  double slope = 46 * std::numbers::pi / 180;  ///< radians: the steepest ground that it stands on
  double gravity = 9.81;                       ///< metres a second squared
  double fall = 50;                            ///< metres a second: it falls no faster
  double skin = 0.005;                         ///< metres kept from surfaces
};

/// Every way that it goes is swept, so that its capsule overlaps no rock after a move, to 1e-6 m; only ground
/// that changed around it can hold it. Then a move pushes it out, or says that it is buried, and escape() is
/// the way out. The same moves on the same ground give the same bits.
class Walker {
 public:
  /// `feet`: the capsule's lowest point. Throws Error{usage} for sizes that make no capsule.
  explicit Walker(const WalkerSettings& settings, Vec3d feet = {});

  /// Walks for `seconds` at `wish` metres a second, of which x and y count; in the air, too. Either may be 0.
  /// False where it is buried: it overlaps rock, and a few pushes find no way out, or only one to where it
  /// would fall out of the world. It stays where it is then.
  bool move(const Collider& ground, Vec3d wish, double seconds);
  bool stuck() const { return stuck_; }  ///< what the last move() said: that it is buried

  /// The nearest feet, no more than `distance` metres off, at which the capsule fits and has ground below,
  /// however far down: its own where it fits already. Another place is nearer by no more than a tenth, or 5
  /// cm; room that leaves it less play than 5 cm may be overlooked. Nothing where there is no such place:
  /// then a game sets its player down elsewhere. Takes milliseconds where rock of some metres is to be left.
  std::optional<Vec3d> free_place(const Collider& ground, double distance = 50) const;
  /// Goes there at once, and falls from there on; false where there is no such place.
  bool escape(const Collider& ground, double distance = 50);

  /// Puts it down on ground that lies no more than a step below; false where there is none.
  bool settle(const Collider& ground);

  Vec3d feet() const { return feet_; }
  Capsule capsule() const { return capsule_at(feet_); }
  /// The velocity of a fall or of sliding down what is too steep, metres a second; 0 on the ground, whatever
  /// it wishes.
  Vec3d velocity() const { return velocity_; }
  bool grounded() const { return grounded_; }
  /// The normal of what it stands on; up where it stands on nothing.
  Vec3d ground_normal() const { return normal_; }
  const WalkerSettings& settings() const { return settings_; }

  Capsule capsule_at(Vec3d feet) const;

  struct Footing {
    bool found = false;
    Vec3d feet, normal, point;
  };
  /// The place to stand that it comes to when it is let down by up to `depth` metres.
  Footing footing(const Collider& ground, Vec3d feet, double depth) const {
    return let_down(ground, feet, depth, false);
  }
  /// Where it comes to stand when it lifts its feet by up to a step, goes to level (to.x, to.y) as far as it
  /// can, and puts them down again, by up to a step lower than they were.
  Footing stride(const Collider& ground, Vec3d feet, Vec3d to) const {
    return lift_over(ground, feet, to, false);
  }

 private:
  bool walkable(const Collider& ground, Vec3d point, Vec3d normal) const;
  double travel(const Collider& ground, Vec3d feet, Vec3d motion) const;
  /// `steep`: what is too steep to stand on will do.
  Footing let_down(const Collider& ground, Vec3d feet, double depth, bool steep) const;
  Footing lift_over(const Collider& ground, Vec3d feet, Vec3d to, bool steep) const;
  bool fits(const Collider& ground, Vec3d feet) const;
  bool leaves_world(const Collider& ground, const Slide& slide) const;
  void walk(const Collider& ground, Vec3d way);
  void fly(const Collider& ground, Vec3d way, double seconds);
  void stand(const Footing& footing);

  WalkerSettings settings_;
  double floor_;  ///< least z of a walkable normal
  Vec3d feet_, normal_{0, 0, 1};
  Vec3d velocity_;
  bool grounded_ = false, stuck_ = false;
};

}  // namespace tafoni::query
