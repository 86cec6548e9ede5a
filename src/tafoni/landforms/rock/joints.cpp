// Two sets of parallel planes at a random angle: one joint in each cell across a set, at a random place and
// of a random strength, bent by noise. Noise along it opens some stretches and closes others.

#include "tafoni/landforms/rock/joints.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

using std::numbers::pi;

enum class JointsStream : std::uint64_t { direction = 1 };

/// Chosen by eye; lengths are in spacings of the joints.
namespace joints_look {
// Radians between the two sets: conjugate joints meet at somewhat less than a right angle.
constexpr double between_sets = 1.3;
// Joints wander from their planes by this, in waves a spacing.
constexpr double wander = 0.35, wander_scale = 0.7;
// A joint's place in its cell, and how much it weakens the rock.
constexpr double nearest = 0.1, farthest = 0.9, weakest = 0.25, strongest = 1.0;
// How the noise along a joint makes it tight in one stretch and open in the next: gain and loss.
constexpr double open_gain = 2.5, open_loss = 0.6;
}  // namespace joints_look

}  // namespace

Joints::Joints(double spacing, double width, std::uint64_t seed) : spacing_(spacing), width_(width) {
  Random random(seed, JointsStream::direction);
  const double first = random.uniform(0, pi);
  for (int i = 0; i < std::ssize(sets_); ++i) {
    const double angle = first + joints_look::between_sets * i;
    const Vec3d along{std::cos(angle), std::sin(angle), 0};
    sets_[i] = {{-along.y, along.x, 0}, along, hash_combine(seed, i)};
  }
}

double Joints::weakness(const Set& set, Vec3d p) const {
  const double wander = fbm(p * (joints_look::wander_scale / spacing_), 2, set.seed) - 0.5;
  const double u = dot(p, set.across) / spacing_ + joints_look::wander * wander;
  const auto cell = floor_to<std::int64_t>(u);
  double weakest = 0;
  for (std::int64_t c = cell - 1; c <= cell + 1; ++c) {
    Random random(set.seed, static_cast<std::uint64_t>(c));
    const double at = static_cast<double>(c) + random.uniform(joints_look::nearest, joints_look::farthest);
    const double strength = random.uniform(joints_look::weakest, joints_look::strongest);
    const double d = std::abs(u - at) * spacing_ / width_;
    if (d < 1) weakest = std::max(weakest, strength * (1 - d * d) * (1 - d * d));
  }
  // A joint is tight in one stretch and open in the next.
  const double open = fbm(p * (1.0 / spacing_) + Vec3d{17, 5, 3}, 2, set.seed + 1);
  return weakest * std::clamp(joints_look::open_gain * open - joints_look::open_loss, 0.0, 1.0);
}

double Joints::weakness(Vec3d p) const {
  return std::max(weakness(sets_[0], p), weakness(sets_[1], p));
}

Vec3d Joints::along(Vec3d wanted) const {
  Vec3d best = wanted;
  double nearest = -1;
  for (const Set& set : sets_) {
    const double cosine = dot(set.along, wanted);
    if (std::abs(cosine) <= nearest) continue;
    nearest = std::abs(cosine);
    best = cosine < 0 ? -set.along : set.along;
  }
  return best;
}

}  // namespace tafoni::landforms::impl
