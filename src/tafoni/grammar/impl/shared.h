#pragma once
// What the solids share.

#include <cmath>
#include <string_view>

#include "tafoni/grammar/solid.h"

namespace tafoni::grammar::impl {

inline constexpr double least_size = 1e-3, greatest_size = 1e4;  // metres

/// A solid whose sizes are its members.
template <class S>
SolidPtr make_solid(const std::vector<ParamInfo>& infos, const Values& sizes, std::string_view name) {
  auto solid = std::make_shared<S>();
  assign(infos, solid.get(), sizes, name);
  return solid;
}

/// The middles of the six sides of a box of these half widths.
inline std::vector<Bond> six_sides(Vec3d half) {
  return {{{half.x, 0, 0}, {1, 0, 0}},   {{-half.x, 0, 0}, {-1, 0, 0}}, {{0, half.y, 0}, {0, 1, 0}},
          {{0, -half.y, 0}, {0, -1, 0}}, {{0, 0, half.z}, {0, 0, 1}},   {{0, 0, -half.z}, {0, 0, -1}}};
}

inline Box3d box_about_middle(Vec3d half) {
  return {-half, half};
}

/// std::hypot without its care for numbers near the ends of double's range, which costs more than the solids.
inline double length_of(double a, double b) {
  return std::sqrt(a * a + b * b);
}

/// Distance to the segment from a to b.
inline double to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  return length(p - (a + along * t));
}

}  // namespace tafoni::grammar::impl
