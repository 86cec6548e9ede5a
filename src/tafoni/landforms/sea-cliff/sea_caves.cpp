// Sea caves as walks: from each strongly attacked place, far enough from the others, a walk goes along the
// joints and turns to the weakest rock ahead, until it is spent, loses its roof or comes out on the other
// side of a headland, as an arch. It leaves a row of tubes, and a narrower one above for the fissure.

#include "tafoni/landforms/sea-cliff/sea_caves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/landforms/site/spatial_hash.h"

namespace tafoni::landforms::impl {
namespace {

constexpr double half_turn = std::numbers::pi;

/// Walks have the numbers from 1 on.
enum class SeaCavesStream : std::uint64_t { first_walk = 1, places = 0xcafe };

/// Chosen by eye; lengths are metres where nothing else is said.
namespace sea_caves_look {
// Mouths are no nearer than the spacing times a random share from this to 1, so that they stand in no row.
constexpr double least_apart = 0.6;
// A walk follows the joint, bent inward by this share, where their cosine is above that limit: a joint that
// runs along the cliff leads into no cave.
constexpr double joint_inward = 0.3, joint_cosine = 0.45;
// The effect from which a cave is as long and wide as any is 1 / `effect_gain`.
constexpr double effect_gain = 1.6;
// Length, as a share of the parameter: least by chance; at no effect.
constexpr double least_length = 0.35, weak_length = 0.4;
// Radius of the mouth, in the parameter's: at no effect, more of it at full, and by chance.
constexpr double weak_mouth = 0.8, strong_mouth = 0.7, least_mouth = 0.85, mouth_chance = 0.3;
// A mouth's axis lies so far above the sea and begins so far before the face, in radii of the mouth.
constexpr double mouth_above = 0.3, mouth_before = 0.8;
// Step of a walk in radii of the passage, and how the floor rises along it.
constexpr double step = 0.7, rise = 0.06;
// A cave that has found no roof after so many radii of the mouth is given up.
constexpr double cleft = 4;
// Rock over a cave's axis: so many radii of the mouth, and metres more.
constexpr double roof = 2, roof_more = 1;
// A headland up to this many lengths thick is pierced; the ways tried are so many radians to either side.
constexpr double headland = 1.3, headland_turn = 0.25;
// Steering: a turn in radians, how far ahead in steps the rock is felt, what chance and a turn count beside
// its resistance, and the resistance above which a walk loses length.
constexpr double turn = 0.22, ahead = 2, chance = 0.1, straightness = 0.02, hard = 0.45;
// Passages narrow inward by this share, arches in their middle; and their width wavers by a share, with so
// many radians from step to step.
constexpr double taper = 0.62, arch_taper = 0.5, waver = 0.12, waver_step = 1.3;
// The fissure above: how high, in radii of the passage, and its width.
constexpr double fissure_low = 0.5, fissure_high = 1.2, fissure_width = 0.62;
}  // namespace sea_caves_look

Vec3d turn_by(Vec3d d, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * d.x - s * d.y, s * d.x + c * d.y, 0};
}

Vec3d horizontal(Vec3d d) {
  return normalized(Vec3d{d.x, d.y, 0});
}

/// One cave's way into the rock.
class Walk {
 public:
  Walk(const field::CompiledField& field, const Ground& ground, const Joints& joints, const CaveSettings& s,
       const Attack& attack, std::uint64_t id)
      : field_(field), ground_(ground), joints_(joints), s_(s), random_(s.seed, id) {
    const Vec3d inward = -horizontal(to_double(attack.at.normal));
    const Vec3d joint = joints.along(inward);
    // Along the joint unless it runs along the cliff.
    heading_ = dot(joint, inward) > sea_caves_look::joint_cosine
                   ? horizontal(joint + sea_caves_look::joint_inward * inward)
                   : inward;
    const double strength = std::min(1.0, sea_caves_look::effect_gain * attack.effect);
    limit_ = s.cave_length * (sea_caves_look::least_length + 0.65 * random_.uniform()) *
             (sea_caves_look::weak_length + 0.6 * strength);
    mouth_ = s.cave_radius * (sea_caves_look::weak_mouth + sea_caves_look::strong_mouth * strength) *
             (sea_caves_look::least_mouth + sea_caves_look::mouth_chance * random_.uniform());
    at_ = attack.at.position;
    at_.z = std::max(at_.z, s.sea_z + sea_caves_look::mouth_above * mouth_);
    at_ += heading_ * (-sea_caves_look::mouth_before * mouth_);
    step_ = sea_caves_look::step * s.cave_radius;
  }

  /// Appends the tubes to `caves` unless nothing came of it.
  void run(SeaCaves& caves) {
    std::vector<Vec3d> path = {at_};
    const double far_side = through();
    if (far_side > 0) limit_ = far_side + mouth_;
    double length_of = 0;
    bool was_inside = false, was_roofed = false, arch = false;
    while (length_of < limit_) {
      if (far_side <= 0) steer();
      const Vec3d next = at_ + heading_ * step_ + Vec3d{0, 0, sea_caves_look::rise * step_};
      if (!ground_.usable(next)) break;
      const bool inside = field_.value(next) > 0, under = roofed(next);
      arch = was_inside && !inside;
      // Where the face leans back the cave begins as a cleft; once under a roof it stays there.
      if (!arch && !under && (was_roofed || length_of > sea_caves_look::cleft * mouth_)) break;
      at_ = next;
      length_of += step_;
      path.push_back(at_);
      if (arch) break;
      was_inside |= inside;
      was_roofed |= under;
    }
    if (!was_inside || !was_roofed || length_of < 2 * step_) return;
    emit(path, arch, caves);
    caves.mouths.push_back(path.front());
    caves.arches += arch;
    caves.length += length_of;
  }

 private:
  /// Distance to open air on the other side of a thin headland; 0 when the rock goes on.
  double through() {
    for (int turns : {0, 1, -1, 2, -2}) {
      const Vec3d d = turn_by(heading_, turns * sea_caves_look::headland_turn);
      bool rock = false;
      for (double t = mouth_; t < sea_caves_look::headland * s_.cave_length; t += 0.5 * step_) {
        const bool solid = field_.value(at_ + d * t) > 0;
        if (rock && !solid) {
          heading_ = d;
          return t;
        }
        rock |= solid;
      }
    }
    return 0;
  }

  double resistance(Vec3d p) const {
    return ground_.resistance(p) * (1 - s_.joints * joints_.weakness(p + ground_.site().origin));
  }

  /// Turns towards the least resistance ahead.
  void steer() {
    Vec3d best = heading_;
    double least = 10;
    for (int i = -2; i <= 2; ++i) {
      const Vec3d d = turn_by(heading_, sea_caves_look::turn * i);
      const double rho = resistance(at_ + d * (sea_caves_look::ahead * step_)) +
                         sea_caves_look::chance * random_.uniform() +
                         sea_caves_look::straightness * std::abs(i);
      if (rho >= least) continue;
      least = rho;
      best = d;
    }
    heading_ = best;
    // Hard rock wears the waves out sooner.
    limit_ -= step_ * std::max(0.0, least - sea_caves_look::hard);
  }

  /// Whether the rock above bears, so that no slit opens in the clifftop.
  bool roofed(Vec3d p) const {
    return ground_.height(p.x, p.y) > p.z + sea_caves_look::roof * mouth_ + sea_caves_look::roof_more;
  }

  /// A lower tube and, narrower, the fissure above it, both dying away inward.
  void emit(const std::vector<Vec3d>& path, bool arch, SeaCaves& caves) {
    const auto n = static_cast<double>(path.size() - 1);
    const double fissure = random_.uniform(sea_caves_look::fissure_low, sea_caves_look::fissure_high),
                 phase = random_.uniform(0, 2 * half_turn);
    const auto radius = [&](std::size_t i) {
      const double t = static_cast<double>(i) / n;
      const double taper =
          arch ? 1 - sea_caves_look::arch_taper * std::sin(half_turn * t) : 1 - sea_caves_look::taper * t;
      return mouth_ * taper *
             (1 +
              sea_caves_look::waver * std::sin(sea_caves_look::waver_step * static_cast<double>(i) + phase));
    };
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const double r = 0.5 * (radius(i) + radius(i + 1));
      caves.tubes.push_back({path[i], path[i + 1], r});
      const double up0 = fissure * radius(i), up1 = fissure * radius(i + 1);
      caves.tubes.push_back(
          {path[i] + Vec3d{0, 0, up0}, path[i + 1] + Vec3d{0, 0, up1}, sea_caves_look::fissure_width * r});
    }
  }

  const field::CompiledField& field_;
  const Ground& ground_;
  const Joints& joints_;
  const CaveSettings& s_;
  Random random_;
  Vec3d at_, heading_;
  double limit_, mouth_, step_;
};

}  // namespace

SeaCaves sea_caves(const field::CompiledField& field, const Ground& ground, const Joints& joints,
                   std::vector<Attack> attacks, const CaveSettings& settings, Progress& progress) {
  std::stable_sort(attacks.begin(), attacks.end(),
                   [](const Attack& a, const Attack& b) { return a.effect > b.effect; });
  SeaCaves caves;
  SpatialHash taken(2 * settings.cave_spacing, 64);
  Random spread(settings.seed, SeaCavesStream::places);
  for (const Attack& attack : attacks) {
    progress.check();
    const double apart = settings.cave_spacing * spread.uniform(sea_caves_look::least_apart, 1.0);
    if (taken.any_near(attack.at.position, apart)) continue;
    taken.insert(attack.at.position);
    Walk(field, ground, joints, settings, attack, taken.size()).run(caves);
  }
  return caves;
}

}  // namespace tafoni::landforms::impl
