#pragma once
// Where a shape stands: turned and moved, without scale.

#include "tafoni/grammar/solid.h"
#include "tafoni/math/vec.h"

namespace tafoni::grammar {

/// Axes are orthonormal and right-handed.
struct Pose {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< the own axes, as seen from outside
  Vec3d at;

  Vec3d turned(Vec3d own) const { return x * own.x + y * own.y + z * own.z; }
  Vec3d placed(Vec3d own) const { return at + turned(own); }
  Vec3d own(Vec3d placed) const {
    const Vec3d d = placed - at;
    return {dot(d, x), dot(d, y), dot(d, z)};
  }
  Pose placed(const Pose& own) const { return {turned(own.x), turned(own.y), turned(own.z), placed(own.at)}; }
  Bond placed(const Bond& own) const { return {placed(own.point), turned(own.direction)}; }
  /// Encloses the box once it is placed. An empty box stays empty.
  Box3d placed(const Box3d& own) const {
    Box3d out;
    for (int corner = 0; corner < 8 && !own.empty(); ++corner)
      out.expand(placed(Vec3d{corner & 1 ? own.hi.x : own.lo.x, corner & 2 ? own.hi.y : own.lo.y,
                              corner & 4 ? own.hi.z : own.lo.z}));
    return out;
  }
};

/// A turn about `axis` (unit) by `angle` radians, counter-clockwise seen against the axis.
Pose turn(Vec3d axis, double angle);
/// The least turn that brings unit `from` to unit `to`.
Pose turn(Vec3d from, Vec3d to);

}  // namespace tafoni::grammar
