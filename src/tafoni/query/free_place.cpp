// The nearest place where a walker fits, by branch and bound: cubes of places, nearest first, are left out
// where a point of the walker's axis stays in rock all over the cube, and else halved. Distances to the
// surface change no faster than places do, so that nothing is left out wrongly.

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/query/walker.h"

namespace tafoni::query {
namespace {

/// What free_place() promises: shares of the way, and metres.
constexpr double nearly = 0.1, finest = 0.05;
/// Metres, half a side: larger cubes are halved unseen, since the surface near them may be far to look for.
constexpr double largest_looked_at = 8;
/// Metres: how far below there may be ground.
constexpr double lowest_ground = 1e7;
/// Cubes that are looked at before the search ends with what it has; more than any rock that was tried needs.
constexpr int most_cubes = 1 << 16;

/// Feet within `half` of the middle along each axis.
struct Cube {
  double near = 0;  ///< metres from where the search began
  int number = 0;   ///< in the order made: of equally near cubes the first
  Vec3d middle;
  double half = 0;

  bool operator<(const Cube& other) const {  // the nearest is on top of a queue
    return std::tie(near, number) > std::tie(other.near, other.number);
  }
};

double cube_distance(Vec3d middle, double half, Vec3d p) {
  const auto off = [half](double d) { return std::max(std::abs(d) - half, 0.0); };
  const Vec3d d = p - middle;
  return length(Vec3d{off(d.x), off(d.y), off(d.z)});
}

/// Whether the shape overlaps rock wherever it is moved by no more than `play` metres.
bool stays_in_rock(const Collider& ground, const Capsule& shape, double play) {
  for (const double share : {0.5, 0.0, 1.0}) {
    const Vec3d p = shape.a + (shape.b - shape.a) * share;
    const auto near = ground.closest(p, play + shape.radius);
    if (near ? near->distance + play < shape.radius : ground.solid(p)) return true;
  }
  return false;
}

bool ground_below(const Collider& ground, Vec3d p) {
  const auto below = ground.ray(p, {0, 0, -1}, lowest_ground);
  return below && !below->from_rock;
}

/// Whether no place of the cube has ground below.
bool bottomless(const Collider& ground, Vec3d middle, double half) {
  return !ground_below(ground, middle) &&
         !ground.sweep(Sphere{middle, half * std::sqrt(3.0)}, {0, 0, -lowest_ground});
}

}  // namespace

bool Walker::fits(const Collider& ground, Vec3d feet) const {
  Capsule shape = capsule_at(feet);
  shape.radius += settings_.skin / 2;
  return !ground.overlaps(shape) && ground_below(ground, shape.a);
}

std::optional<Vec3d> Walker::free_place(const Collider& ground, double distance) const {
  if (!(distance >= 0) || !std::isfinite(distance))
    fail(ErrorKind::usage, "a place within {} m cannot be looked for: give 0 or more", distance);
  if (fits(ground, feet_)) return feet_;
  std::optional<Vec3d> best;
  double limit = distance;
  std::priority_queue<Cube> cubes;
  int made = 0;
  cubes.push({0, made++, feet_, distance});
  for (int looked = 0; !cubes.empty() && looked < most_cubes; ++looked) {
    const Cube cube = cubes.top();
    cubes.pop();
    if (cube.near > limit) break;
    if (cube.half <= largest_looked_at) {
      if (stays_in_rock(ground, capsule_at(cube.middle), cube.half * std::sqrt(3.0)) ||
          bottomless(ground, capsule_at(cube.middle).a, cube.half))
        continue;
      const double way = length(cube.middle - feet_);
      if (way <= limit && fits(ground, cube.middle)) {
        best = cube.middle;
        limit = way - std::max(finest, nearly * way);
      }
    }
    const double half = cube.half / 2;
    if (2 * cube.half <= finest) continue;
    for (unsigned i = 0; i < 8; ++i) {
      const Vec3d middle =
          cube.middle + Vec3d{i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half};
      const double near = cube_distance(middle, half, feet_);
      if (near <= limit) cubes.push({near, made++, middle, half});
    }
  }
  return best;
}

bool Walker::escape(const Collider& ground, double distance) {
  const std::optional<Vec3d> place = free_place(ground, distance);
  if (!place) return false;
  feet_ = *place;
  velocity_ = {};
  normal_ = {0, 0, 1};
  grounded_ = stuck_ = false;
  return true;
}

}  // namespace tafoni::query
