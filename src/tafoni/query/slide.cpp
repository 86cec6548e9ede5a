// A motion goes to its first contact, loses what leads into the surface there, and goes on with the rest,
// along one plane or the crease of two, until nothing of it is left.

#include <array>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/query/collider.h"

namespace tafoni::query {
namespace {

/// Surfaces that one motion may lean on; with more it ends where it is.
constexpr int most_planes = 8;
/// A motion may point into a plane by this share of its length, which is rounding.
constexpr double into_plane = 1e-9;
/// Metres. What is left of a motion below this is not worth another sweep.
constexpr double nothing_left = 1e-9;
/// Pushes out of the rock that are tried for a shape that overlaps it.
constexpr int most_pushes = 16;
/// A surface whose normal has less than this across it is level: it has no take_as_wall to be taken for.
constexpr double least_level = 1e-6;

/// What is left of a motion that must not enter any of the planes.
Vec3d along_planes(Vec3d motion, const std::array<Vec3d, most_planes>& normals, int count) {
  const auto allowed = [&](Vec3d m) {
    const double least = -into_plane * length(m);
    for (int i = 0; i < count; ++i)
      if (dot(m, normals[i]) < least) return false;
    return true;
  };
  if (allowed(motion)) return motion;
  const auto normal = [&](int i) { return normals[i]; };
  Vec3d best;
  double longest = 0;
  const auto consider = [&](Vec3d m) {
    const double size = dot(m, motion);
    if (size > longest && allowed(m)) best = m, longest = size;
  };
  for (int i = 0; i < count; ++i) {
    Vec3d m = motion - normal(i) * dot(motion, normal(i));
    m -= normal(i) * dot(m, normal(i));  // once more: the first leaves rounding of the whole motion's size
    consider(m);
  }
  if (longest > 0) return best;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < i; ++j) {
      const Vec3d crease = normalized(cross(normal(i), normal(j)));
      consider(crease * dot(motion, crease));
    }
  return best;
}

/// What a surface that is too steep to climb is taken for.
Vec3d take_as_wall(Vec3d normal, double wall) {
  if (normal.z >= wall) return normal;
  const Vec3d level{normal.x, normal.y, 0};
  return length(level) > least_level ? normalized(level) : normal;
}

}  // namespace

/// Moves `at` until the shape overlaps nothing; false when some steps do not get there.
bool Collider::free(const Capsule& shape, Vec3d& at, double skin) const {
  for (int i = 0; i < most_pushes; ++i) {
    const auto overlap = contact(shape.moved(at));
    if (!overlap) return true;
    if (!std::isfinite(overlap->depth)) return false;
    at += overlap->normal * (overlap->depth + skin);
  }
  return !overlaps(shape.moved(at));
}

Slide Collider::slide(const Capsule& shape, Vec3d motion, const SlideSettings& settings) const {
  if (settings.iterations < 1 || !(settings.skin >= 0) || !std::isfinite(settings.skin))
    fail(ErrorKind::usage, "a slide needs at least one iteration and a finite skin of 0 m or more");
  Slide result;
  std::array<Vec3d, most_planes> normals;
  int planes = 0;
  Vec3d left = motion;
  for (int i = 0; i < settings.iterations; ++i) {
    auto hit = sweep(shape.moved(result.moved), left);
    if (hit && hit->depth > 0) {
      const Vec3d before = result.moved;
      if (!free(shape, result.moved, settings.skin)) {
        result.moved = before;
        result.stuck = true;
        return result;
      }
      result.freed = true;
      hit = sweep(shape.moved(result.moved), left);
    }
    if (!hit) {
      result.moved += left;
      return result;
    }
    result.hits.push_back(*hit);
    const double size = length(left);
    if (!(size > 0)) return result;
    const double toward = -dot(left, hit->normal) / size;
    // A gap of `skin` along the normal is wider along the motion.
    const double travel = toward > 0 ? std::max(0.0, hit->time * size - settings.skin / toward) : 0.0;
    result.moved += left * (travel / size);
    left = left * (1 - travel / size);
    if (planes == most_planes) return result;
    normals[planes++] = take_as_wall(hit->normal, settings.wall);
    left = along_planes(left, normals, planes);
    if (!(dot(left, motion) > 0) || length(left) < nothing_left) return result;
  }
  return result;
}

}  // namespace tafoni::query
