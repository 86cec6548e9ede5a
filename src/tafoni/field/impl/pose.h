#pragma once
// Where a placed tree stands, ready to compute with.

#include <cmath>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

/// p = position + scale Rz(turn) Ry(tilt) own.
struct Pose {
  Vec3d position;
  double scale, inverse;
  double cos_turn, sin_turn, cos_tilt, sin_tilt;

  explicit Pose(const Placement& p)
      : position(p.position),
        scale(p.scale),
        inverse(1 / p.scale),
        cos_turn(std::cos(p.turn)),
        sin_turn(std::sin(p.turn)),
        cos_tilt(std::cos(p.tilt)),
        sin_tilt(std::sin(p.tilt)) {}

  Vec3d to_own(Vec3d p) const {
    const Vec3d d = (p - position) * inverse;
    const double x = cos_turn * d.x + sin_turn * d.y, y = cos_turn * d.y - sin_turn * d.x;
    return {cos_tilt * x - sin_tilt * d.z, y, sin_tilt * x + cos_tilt * d.z};
  }
  /// Turned, neither moved nor scaled.
  Vec3d turn(Vec3d own) const {
    const double x = cos_tilt * own.x + sin_tilt * own.z, z = cos_tilt * own.z - sin_tilt * own.x;
    return {cos_turn * x - sin_turn * own.y, sin_turn * x + cos_turn * own.y, z};
  }
  Vec3d to_world(Vec3d own) const { return position + turn(own) * scale; }

  /// Boxes that hold every point of a box, seen from the other side; a little larger for rounding.
  Box3d own_box(const Box3d& box) const {
    return map_corners(box, [this](Vec3d p) { return to_own(p); });
  }
  Box3d world_box(const Box3d& box) const {
    return map_corners(box, [this](Vec3d p) { return to_world(p); });
  }

 private:
  template <class Map>
  static Box3d map_corners(const Box3d& box, const Map& map) {
    if (box.empty()) return box;
    if (!box.bounded()) return Box3d::everything();
    Box3d out;
    for (int c = 0; c < 8; ++c)
      out.expand(
          map({c & 1 ? box.hi.x : box.lo.x, c & 2 ? box.hi.y : box.lo.y, c & 4 ? box.hi.z : box.lo.z}));
    constexpr double rounding = 1e-6;
    return out.grown(rounding);
  }
};

/// Throws Error{usage} for a placement that is not finite or does not scale by a positive factor.
void check(const Placement& placement);

/// A placement as data.
std::vector<ParamInfo> placement_params();

}  // namespace tafoni::field::impl
