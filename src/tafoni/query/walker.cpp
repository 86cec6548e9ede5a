// A walker on the ground slides along the surface and is let down onto it, then tries to stride over what
// stopped it, a step up, forward and down; in the air it falls and drifts.

#include "tafoni/query/walker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tafoni/core/error.h"

namespace tafoni::query {
namespace {

constexpr Vec3d up{0, 0, 1};

/// Metres, added to the radius: how far beyond itself a walker looks for footing.
constexpr double near_beyond = 0.15;
/// A walk that ends this near to its goal, as a share of its length, needs no other way to be tried.
constexpr double near_goal = 0.05;
/// Footing beyond an obstacle counts where it is this near to the place looked at, as a share of the way
/// there.
constexpr double near_place = 0.1;
/// Surfaces whose normal's z is at most this are walls or roofs: nobody asks what lies behind their edge.
constexpr double least_edge = 0.05;
/// How far behind an edge the ground is asked for, in radii, and how much further down than the steepest
/// slope would lead, in units of that distance.
constexpr double behind_edge = 0.05, below_slope = 0.5;
/// The skin is kept along a normal; down, it is that over the normal's z, which counts as no less than this.
constexpr double least_rise = 0.1;
/// Metres. Another footing must be nearer to the goal by this, which is more than rounding, to be preferred.
constexpr double clearly = 1e-6;
/// Metres. A shorter way has no direction in which to look for footing.
constexpr double no_way = 1e-9;
/// Radians, just below a right angle, whose tangent is without end.
constexpr double steepest = 1.57;

Vec3d level(Vec3d v) {
  return {v.x, v.y, 0};
}

}  // namespace

Walker::Walker(const WalkerSettings& settings, Vec3d feet)
    : settings_(settings), floor_(std::cos(settings.slope)), feet_(feet) {
  const WalkerSettings& s = settings_;
  if (!(s.radius > 0) || !(s.height >= 2 * s.radius) || !std::isfinite(s.height))
    fail(ErrorKind::usage,
         "a walker of radius {} m and height {} m is no capsule: give a height of two radii or more",
         s.radius, s.height);
  const bool finite = std::isfinite(s.step) && std::isfinite(s.gravity) && std::isfinite(s.skin);
  if (!finite || !(s.step >= 0) || !(s.slope >= 0 && s.slope < steepest) || !(s.gravity >= 0) ||
      !(s.fall > 0) || !(s.skin > 0))
    fail(ErrorKind::usage,
         "a walker needs a step and gravity of 0 or more, a slope below 90 degrees, and a skin and fall "
         "above 0");
}

Capsule Walker::capsule_at(Vec3d feet) const {
  return {feet + up * settings_.radius, feet + up * (settings_.height - settings_.radius), settings_.radius};
}

/// Whether what is touched can be stood on: the surface, or, at the edge of a step, what lies behind the
/// edge.
bool Walker::walkable(const Collider& ground, Vec3d point, Vec3d normal) const {
  if (normal.z >= floor_) return true;
  if (normal.z <= least_edge) return false;
  const double back = behind_edge * settings_.radius;
  const Vec3d behind = point - normalized(level(normal)) * back;
  const double reach = back * (std::tan(settings_.slope) + below_slope);
  const auto hit = ground.ray(behind + up * reach, -up, 2 * reach);
  return hit && !hit->from_rock && hit->normal.z >= floor_;
}

/// How far the capsule goes along a motion before it meets something, less the skin; metres.
double Walker::travel(const Collider& ground, Vec3d feet, Vec3d motion) const {
  const double size = length(motion);
  if (size == 0) return 0;
  const auto hit = ground.sweep(capsule_at(feet), motion);
  if (!hit) return size;
  const double toward = -dot(motion, hit->normal) / size;
  return toward > 0 ? std::max(0.0, hit->time * size - settings_.skin / toward) : 0.0;
}

Walker::Footing Walker::let_down(const Collider& ground, Vec3d feet, double depth, bool steep) const {
  const Vec3d down = up * -depth;
  const Capsule shape = capsule_at(feet);
  const auto hit = ground.sweep(shape, down);
  if (!hit || hit->depth > 0) return {};
  if (steep || walkable(ground, hit->point, hit->normal)) {
    const double way =
        std::max(0.0, hit->time * depth - settings_.skin / std::max(hit->normal.z, least_rise));
    return {true, feet - up * way, hit->normal, hit->point};
  }
  // Beside the foot of a wall the wall is met first: the ground may lie just below.
  const Slide slide = ground.slide(shape, down, {.iterations = 4, .skin = settings_.skin});
  if (slide.stuck || length(level(slide.moved)) > settings_.radius) return {};
  for (const SweepHit& h : slide.hits)
    if (h.normal.z >= floor_) return {true, feet + slide.moved, h.normal, h.point};
  return {};
}

Walker::Footing Walker::lift_over(const Collider& ground, Vec3d feet, Vec3d to, bool steep) const {
  const double lift = travel(ground, feet, up * settings_.step);
  const Vec3d raised = feet + up * lift;
  const Slide over = ground.slide(capsule_at(raised), level(to - feet), {.skin = settings_.skin, .wall = 2});
  if (over.stuck) return {};
  const Footing found = let_down(ground, raised + over.moved, lift + settings_.step + settings_.skin, steep);
  // The round end of the capsule would ride up on edges higher than a step.
  return found.found && found.point.z - feet.z > settings_.step + settings_.skin ? Footing{} : found;
}

void Walker::stand(const Footing& footing) {
  feet_ = footing.feet;
  normal_ = footing.normal;
  grounded_ = true;
  velocity_ = {};
}

bool Walker::settle(const Collider& ground) {
  const Footing found = footing(ground, feet_, settings_.step);
  if (found.found) stand(found);
  return found.found;
}

/// Whether the slide pushed it out of rock to where nothing is below, unlike before.
bool Walker::leaves_world(const Collider& ground, const Slide& slide) const {
  const auto below = [&](Vec3d feet) {
    return ground.ray(feet + up * settings_.radius, -up, std::numeric_limits<double>::infinity()).has_value();
  };
  return slide.freed && !below(feet_ + slide.moved) && below(feet_);
}

void Walker::walk(const Collider& ground, Vec3d way) {
  const double wanted = length(way);
  const Vec3d goal = feet_ + way;
  const auto off = [&](Vec3d feet) { return length(level(goal - feet)); };
  // Uphill along the ground, so that the ground itself is no obstacle.
  Vec3d along = way;
  if (normal_.z >= floor_) along.z = std::max(0.0, -dot(way, level(normal_)) / normal_.z);
  const Slide slide = ground.slide(capsule_at(feet_), along, {.skin = settings_.skin, .wall = floor_});
  stuck_ = slide.stuck || leaves_world(ground, slide);
  if (stuck_) return;
  const Vec3d slid = feet_ + slide.moved;
  Footing best = footing(ground, slid, settings_.step + settings_.skin + std::max(0.0, slide.moved.z));
  if (best.found && off(best.feet) <= near_goal * wanted) return stand(best);
  double error = best.found ? off(best.feet) : std::max(off(slid), near_goal * wanted);
  const auto consider = [&](const Footing& other) {
    if (other.found && off(other.feet) < error - clearly) best = other, error = off(other.feet);
  };
  consider(stride(ground, feet_, goal));
  // What is too steep but no higher than a step is gone over if there is footing beyond it.
  for (double beyond : {settings_.radius + near_beyond, (settings_.radius + near_beyond) / 2}) {
    if (error <= near_goal * wanted || wanted >= beyond || wanted < no_way) break;
    const Vec3d there = feet_ + way * (beyond / wanted);
    const Footing landed = stride(ground, feet_, there);
    if (landed.found && length(level(there - landed.feet)) < near_place * beyond)
      consider(lift_over(ground, feet_, goal, true));
  }
  if (best.found) return stand(best);
  feet_ = slid;
  grounded_ = false;
  normal_ = up;
}

void Walker::fly(const Collider& ground, Vec3d way, double seconds) {
  velocity_.z = std::max(-settings_.fall, velocity_.z - settings_.gravity * seconds);
  const Slide fall = ground.slide(capsule_at(feet_), velocity_ * seconds, {.skin = settings_.skin});
  stuck_ = fall.stuck || leaves_world(ground, fall);
  if (stuck_) return;
  feet_ += fall.moved;
  const Slide drift = ground.slide(capsule_at(feet_), way, {.skin = settings_.skin, .wall = floor_});
  feet_ += drift.moved;
  stuck_ = drift.stuck;
  if (stuck_) return;
  const bool falling = velocity_.z < 0;
  for (const SweepHit& hit : fall.hits) {
    velocity_ -= hit.normal * std::min(0.0, dot(velocity_, hit.normal));
    if (!falling || !walkable(ground, hit.point, hit.normal)) continue;
    const Footing found = footing(ground, feet_, settings_.step);
    if (found.found) return stand(found);
  }
  // Where a cleft holds it, it stands.
  if (falling && fall.hits.size() > 1 && length(fall.moved) < settings_.skin) {
    velocity_ = {};
    grounded_ = true;
  }
}

bool Walker::move(const Collider& ground, Vec3d wish, double seconds) {
  if (!std::isfinite(wish.x) || !std::isfinite(wish.y))
    fail(ErrorKind::usage, "the walker's wish is not finite: give metres a second");
  if (!(seconds >= 0) || !std::isfinite(seconds))
    fail(ErrorKind::usage, "a move of {} s cannot be made: give 0 or more", seconds);
  stuck_ = false;
  const Vec3d way = level(wish) * seconds;
  if (grounded_)
    walk(ground, way);
  else
    fly(ground, way, seconds);
  return !stuck_;
}

}  // namespace tafoni::query
