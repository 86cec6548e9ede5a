#pragma once
// One triangle against points, segments, rays and moving spheres and capsules, in double. What a face, an
// edge and a vertex do is worked out apart, so that contacts are exact to rounding.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "tafoni/math/vec.h"

namespace tafoni::query::impl {

struct Triangle {
  Vec3d v[3];
  /// Twice the area long, outward; zero for a triangle without area.
  Vec3d cross() const { return tafoni::cross(v[1] - v[0], v[2] - v[0]); }
};

/// The point of the triangle nearest to p.
Vec3d nearest_point(const Triangle& t, Vec3d p);

/// Nearest points of a segment and of a triangle; the same point where they cross.
struct NearestPair {
  Vec3d on_segment, on_triangle;
  double squared = 0;
};
NearestPair nearest_pair(const Triangle& t, Vec3d a, Vec3d b);

/// Where from + s * along meets the triangle, or nothing. Two triangles that share an edge (the same two
/// points) leave no gap: a ray through it meets one of them at least.
std::optional<double> ray_hit(const Triangle& t, Vec3d from, Vec3d along);

/// When a sphere or a capsule that moves by `motion` first comes within `radius` of the triangle: a share of
/// the motion of at most `most`.
struct MovingHit {
  double time = 0;
  Vec3d point, normal;   ///< of contact; unit, from there towards the shape
  bool overlap = false;  ///< the shape is nearer than touching before it moves; only this is told then
};
std::optional<MovingHit> moving_hit(const Triangle& t, Vec3d a, Vec3d b, double radius, Vec3d motion,
                                    double most = 1);

/// Angle that the triangle takes up around its point q, as a share of a full turn: a half on an edge.
double angle_at(const Triangle& t, Vec3d q, double tolerance);

}  // namespace tafoni::query::impl
