#include "tafoni/grammar/pose.h"

#include <numbers>

namespace tafoni::grammar {

Pose turn(Vec3d axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto rotate = [&](Vec3d v) { return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c)); };
  return {rotate({1, 0, 0}), rotate({0, 1, 0}), rotate({0, 0, 1}), {}};
}

Pose turn(Vec3d from, Vec3d to) {
  const Vec3d axis = cross(from, to);
  const double s = length(axis);
  if (s > 1e-12) return turn(axis * (1 / s), std::atan2(s, dot(from, to)));
  if (dot(from, to) > 0) return {};
  // Half a turn about any axis across; an upright one where that is possible.
  const Vec3d across = std::abs(from.z) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
  return turn(normalized(across - from * dot(across, from)), std::numbers::pi);
}

}  // namespace tafoni::grammar
