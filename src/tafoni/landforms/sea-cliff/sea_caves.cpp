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

enum class Stream : std::uint64_t { places = 0xcafe };

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
    heading_ = dot(joint, inward) > 0.45 ? horizontal(joint + 0.3 * inward) : inward;
    limit_ =
        s.cave_length * (0.35 + 0.65 * random_.uniform()) * (0.4 + 0.6 * std::min(1.0, 1.6 * attack.effect));
    mouth_ =
        s.cave_radius * (0.8 + 0.7 * std::min(1.0, 1.6 * attack.effect)) * (0.85 + 0.3 * random_.uniform());
    at_ = attack.at.position;
    at_.z = std::max(at_.z, s.sea_z + 0.3 * mouth_);
    at_ += heading_ * (-0.8 * mouth_);
    step_ = 0.7 * s.cave_radius;
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
      const Vec3d next = at_ + heading_ * step_ + Vec3d{0, 0, 0.06 * step_};
      if (!ground_.usable(next)) break;
      const bool inside = field_.value(next) > 0, under = roofed(next);
      arch = was_inside && !inside;
      // Where the face leans back the cave begins as a cleft; once under a roof it stays there.
      if (!arch && !under && (was_roofed || length_of > 4 * mouth_)) break;
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
    for (double turn : {0.0, 0.25, -0.25, 0.5, -0.5}) {
      const Vec3d d = turn_by(heading_, turn);
      bool rock = false;
      for (double t = mouth_; t < 1.3 * s_.cave_length; t += 0.5 * step_) {
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
      const Vec3d d = turn_by(heading_, 0.22 * i);
      const double rho = resistance(at_ + d * (2 * step_)) + 0.1 * random_.uniform() + 0.02 * std::abs(i);
      if (rho >= least) continue;
      least = rho;
      best = d;
    }
    heading_ = best;
    limit_ -= step_ * std::max(0.0, least - 0.45);  // hard rock wears the waves out sooner
  }

  /// Rock above that bears: no slits in the clifftop.
  bool roofed(Vec3d p) const { return ground_.height(p.x, p.y) > p.z + 2 * mouth_ + 1; }

  /// A lower tube and, narrower, the fissure above it, both dying away inward.
  void emit(const std::vector<Vec3d>& path, bool arch, SeaCaves& caves) {
    const auto n = static_cast<double>(path.size() - 1);
    const double fissure = random_.uniform(0.5, 1.2), phase = random_.uniform(0, 2 * half_turn);
    const auto radius = [&](std::size_t i) {
      const double t = static_cast<double>(i) / n;
      const double taper = arch ? 1 - 0.5 * std::sin(half_turn * t) : 1 - 0.62 * t;
      return mouth_ * taper * (1 + 0.12 * std::sin(1.3 * static_cast<double>(i) + phase));
    };
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const double r = 0.5 * (radius(i) + radius(i + 1));
      caves.tubes.push_back({path[i], path[i + 1], r});
      const double up0 = fissure * radius(i), up1 = fissure * radius(i + 1);
      caves.tubes.push_back({path[i] + Vec3d{0, 0, up0}, path[i + 1] + Vec3d{0, 0, up1}, 0.62 * r});
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
  Random spread(settings.seed, Stream::places);
  for (const Attack& attack : attacks) {
    progress.check();
    const double apart = settings.cave_spacing * spread.uniform(0.6, 1.0);
    if (taken.any_near(attack.at.position, apart)) continue;
    taken.insert(attack.at.position);
    Walk(field, ground, joints, settings, attack, taken.size()).run(caves);
  }
  return caves;
}

}  // namespace tafoni::landforms::impl
