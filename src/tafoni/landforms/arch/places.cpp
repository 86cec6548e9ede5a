// The search for arches: blue noise on the terrain's faces, and from each face lines of samples inward, up,
// down and aside, which tell whether a thin wall, a rim with room for a shaft or an opposite face is there,
// and how large an opening fits. Merits weigh soft rock and large openings against deep ones.

#include "tafoni/landforms/arch/places.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tafoni/core/random.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/counts.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::landforms::impl {
namespace {

enum class PlacesStream : std::uint64_t { faces = 0xa7c4, rock = 0x7e, bridges = 0xb1 };

/// Chosen by eye; lengths are in sizes of the greatest opening where nothing else is said.
namespace places_look {
// Defaults: the size in metres at least and in pixels of the terrain, and what follows from it.
constexpr double least_size = 18, size_pixels = 3, thickness = 1.2, roof = 0.2, span = 3;
// Faces are sampled so that so many lie across the terrain, within these distances, and off its border.
constexpr double faces_across = 400, faces_near = 0.3, faces_far = 2, border = 0.5;
// How far down from a place in the air its ground is looked for, and how far other lines go.
constexpr double foot = 2, far = 6;

// A shaft behind a rim: its radius, and in radii how far it lies behind the strip of rock and where that is
// tested.
constexpr double shaft = 0.28, shaft_room = 1.1, shaft_wall = 1.6;
// Widths of the strip of rock between face and shaft, tried in turn, and in roofs its least.
constexpr double strips[] = {0.45, 0.9, 1.5}, least_strip = 1.2;
// The ground may lie so far above the window, and the shaft is cut so far beyond it, to open it for sure.
constexpr double shaft_top = 2.2, shaft_above = 0.5;
// What a pothole loses of its merit: a free arch is the finer one.
constexpr double shaft_merit = 0.5;

// The crown of a window with a shaft lies so far before its middle, in half lengths.
constexpr double crown = 0.25;
// Share of the height between the ground and the roof that is opened, the least opening, and how high its
// sill lies, in heights.
constexpr double height = 0.72, least_height = 0.3, sill = 0.02;
// An opening is judged from faces within so many half heights of its middle.
constexpr double judged = 0.6;
// Half widths in half heights: in the softest rock, what is lost in the hardest, between these resistances.
constexpr double soft_width = 1.45, hard_loss = 0.85, soft = 0.15, hard = 0.75;
// How far aside the end of the wall is looked for, in widths wanted; the share of the wall that may go; and
// the narrowest opening, in half heights.
constexpr double wall_far = 2.5, wall_share = 0.6, least_width = 0.6;
// What the opening's area counts beside the rock's softness.
constexpr double area_merit = 0.7;

// Gaps for bridges: the narrowest, the air under the bridge, how far up the rim may lie; the rock at both
// ends, so far in (in gaps) and so far up, must be there.
constexpr double least_gap = 0.3, least_drop = 0.6, rim = 2, abutment = 0.12, under_rim = 0.15;

// The rock's relief at weakness 1 (the product of both), its unevenness at roughness 1, and the length of
// that.
constexpr double relief = 0.22, relief_scale = 0.6, unevenness = 0.05, wavelength = 0.5;

// A bridge in spans: its rise, breadth and thickness (half of each), in metres the least of these, and how
// far it strays at roughness 1.
constexpr double rise = 0.12, breadth = 0.08, depth = 0.055, stray = 0.08;
constexpr double least_breadth = 1.5, least_depth = 1.2;
}  // namespace places_look

template <class T>
void best_first(std::vector<Found<T>>& found) {
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.merit > b.merit; });
}

class Search {
 public:
  Search(const Ground& ground, const field::CompiledField& field, const ArchParams& p, std::size_t standing)
      : ground_(ground), field_(field), p_(p), standing_(standing), step_(arch_step(p)) {}

  ArchPlaces run(Progress& progress) const {
    SurfaceSampling sampling;
    const Vec3d extent = ground_.box().size();
    sampling.spacing = std::clamp(std::max(extent.x, extent.y) / places_look::faces_across,
                                  places_look::faces_near * p_.size, places_look::faces_far * p_.size);
    sampling.box = ground_.box();
    sampling.seed = hash_combine(ground_.site().seed, PlacesStream::faces);
    const auto steep = static_cast<float>(std::cos(p_.slope * degree));
    sampling.accept = [&](const SurfaceSample& at) {
      return std::abs(at.normal.z) < steep && ground_.usable(at.position, places_look::border * p_.size);
    };
    const auto faces = sample_surface(field_, sampling, progress);
    ArchPlaces found;
    progress.begin("looking for arches", faces.size(), "faces");
    for (const SurfaceSample& face : faces) {
      progress.advance();
      progress.check();
      if (p_.count > 0) {
        if (auto fin = through_fin(face))
          found.fins.push_back(*fin);
        else if (p_.potholes) {
          if (auto cliff = behind_rim(face)) found.cliffs.push_back(*cliff);
        }
      }
      if (p_.bridges > 0)
        if (auto gap = across_gap(face)) found.gaps.push_back(*gap);
    }
    progress.end();
    best_first(found.fins);
    best_first(found.cliffs);
    best_first(found.gaps);
    return found;
  }

 private:
  bool solid(Vec3d p) const { return field_.value(p) > 0; }

  /// The way from `p` along `d` until it is rock (or air), at most `far`; negative when it stays otherwise.
  double until(bool rock, Vec3d p, Vec3d d, double far) const {
    std::vector<Vec3d> line;
    for (double t = step_; t <= far; t += step_) line.push_back(p + d * t);
    std::vector<float> values(line.size());
    field_.values(line, values);
    for (std::size_t i = 0; i < values.size(); ++i)
      if ((values[i] > 0) == rock) return step_ * static_cast<double>(i + 1);
    return -1;
  }

  /// The height of the rock below a place `p` in the air; none where it lies too far down or `p` is rock.
  std::optional<double> foot(Vec3d p) const {
    const double down = until(true, p, {0, 0, -1}, places_look::foot * p_.size);
    if (down < 0 || solid(p)) return {};
    return p.z - down;
  }

  /// The mean resistance of the rock up to `around` metres above and below a place.
  double resistance(Vec3d p, double around) const {
    std::vector<Vec3d> places;
    for (double z : {-0.8, -0.4, 0.0, 0.4, 0.8}) places.push_back(p + Vec3d{0, 0, z * around});
    std::vector<float> rho(places.size());
    ground_.resistances(places, rho);
    return mean(rho);
  }

  /// A window from the face to the air behind it.
  std::optional<Found<Window>> through_fin(const SurfaceSample& face) const {
    const Vec3d inward = normalized(Vec3d{-to_double(face.normal).x, -to_double(face.normal).y, 0});
    const Vec3d start = face.position + inward * (2 * step_);
    const double wall = until(false, start, inward, p_.thickness);
    if (wall < 0) return {};
    const double out = 2 * step_;
    const Vec3d before = face.position - inward * out, behind = start + inward * (wall + out);
    const auto foot0 = foot(before), foot1 = foot(behind);
    if (!foot0 || !foot1) return {};
    Window w;
    w.through = inward;
    w.center = 0.5 * (before + behind);
    w.half_length = 0.5 * length(behind - before) + out;
    return fit_opening(w, std::max(*foot0, *foot1), face.position.z);
  }

  /// A window from the face to a shaft that opens behind the rim, as near to it as leaves rock enough between
  /// them.
  std::optional<Found<Window>> behind_rim(const SurfaceSample& face) const {
    const Vec3d inward = normalized(Vec3d{-to_double(face.normal).x, -to_double(face.normal).y, 0});
    const Vec3d before = face.position - inward * (2 * step_);
    const auto low = foot(before);
    if (!low) return {};
    const double radius = places_look::shaft * p_.size;
    for (const double strip : places_look::strips) {
      const double depth =
          std::max(places_look::least_strip * p_.roof, strip * p_.size) + places_look::shaft_room * radius;
      const Vec3d behind = face.position + inward * depth;
      const double up = until(false, behind, {0, 0, 1}, places_look::shaft_top * p_.size);
      if (up < 0 || !solid(behind)) continue;
      bool bears = true;
      for (double z : {0.3, 0.5, 0.7})
        bears = bears && solid(behind - inward * (places_look::shaft_wall * radius) + Vec3d{0, 0, z * up});
      if (!bears) continue;
      Window w;
      w.through = inward;
      w.half_length = 0.5 * (depth + 6 * step_);
      w.center = before + inward * (w.half_length - 2 * step_);
      w.shaft_at = dot(behind - w.center, inward);
      w.shaft_radius = radius;
      auto made = fit_opening(w, *low, face.position.z);
      if (!made) return {};
      made->what.shaft_top = behind.z + up + places_look::shaft_above * p_.size - made->what.center.z;
      made->merit -= places_look::shaft_merit;
      return made;
    }
    return {};
  }

  /// Fits the opening between the ground at its foot and the roof that must remain above it.
  std::optional<Found<Window>> fit_opening(Window w, double floor, double z) const {
    Vec3d middle = w.center;
    middle.z = z;
    const Vec3d roofed =
        w.shaft_radius > 0
            ? middle - w.through * (dot(middle - w.center, w.through) + places_look::crown * w.half_length)
            : middle;
    if (!solid(roofed)) return {};
    const double up = until(false, roofed, {0, 0, 1}, places_look::far * p_.size);
    const double top = roofed.z + (up < 0 ? places_look::far * p_.size : up);
    const RockTexture rock = arch_texture(ground_, p_, 1);
    const double sway = rock.unevenness + 0.5 * std::abs(rock.relief);
    const double height = std::min(p_.size, places_look::height * (top - floor - p_.roof) - sway);
    if (height < places_look::least_height * p_.size) return {};
    w.half_height = 0.5 * height;
    w.center.z = floor + w.half_height + places_look::sill * height;
    // It is judged once, from a face at about the middle of its height.
    if (std::abs(z - w.center.z) > places_look::judged * w.half_height) return {};
    const double rho = resistance(w.center, w.half_height);
    const double wanted =
        w.half_height * (places_look::soft_width -
                         places_look::hard_loss * smoothstep(places_look::soft, places_look::hard, rho));
    double free = wanted;
    for (double hand : {-1.0, 1.0}) {
      const double wall = until(false, roofed, w.along() * hand, places_look::wall_far * wanted);
      if (wall > 0) free = std::min(free, places_look::wall_share * wall);
    }
    w.half_width = free;
    if (w.half_width < places_look::least_width * w.half_height) return {};
    const double slender = w.half_length / p_.thickness;
    const double area = 4 * w.half_width * w.half_height / (p_.size * p_.size);
    return Found<Window>{1 - rho + places_look::area_merit * area - slender, w};
  }

  /// A bridge to the opposite face of a narrow valley.
  std::optional<Found<Bridge>> across_gap(const SurfaceSample& face) const {
    const Vec3d outward = normalized(Vec3d{to_double(face.normal).x, to_double(face.normal).y, 0});
    const Vec3d start = face.position + outward * (2 * step_);
    const double gap = until(true, start, outward, p_.span);
    if (gap < places_look::least_gap * p_.size || solid(start)) return {};
    const Vec3d other = start + outward * (gap + step_);
    if (!ground_.usable(other, places_look::border * p_.size)) return {};
    const Vec3d middle = 0.5 * (face.position + other);
    const double drop = until(true, middle, {0, 0, -1}, places_look::far * p_.size);
    if (drop > 0 && drop < places_look::least_drop * p_.size) return {};
    // It lies high up, but below the rims on both sides.
    for (Vec3d end : {face.position, other}) {
      const Vec3d in = end + (end == other ? outward : -outward) * (places_look::abutment * gap);
      if (!solid(in) || !solid(in + Vec3d{0, 0, places_look::under_rim * p_.size})) return {};
    }
    const double up =
        until(false, face.position - outward * (3 * step_), {0, 0, 1}, places_look::rim * p_.size);
    if (up < 0) return {};
    return Found<Bridge>{gap / p_.span - up / p_.size,
                         plan_bridge(ground_, p_, face.position, other, standing_)};
  }

  const Ground& ground_;
  const field::CompiledField& field_;
  const ArchParams& p_;
  std::size_t standing_;  ///< bridges that there are already
  double step_;
};

}  // namespace

ArchParams with_defaults(ArchParams p, const Ground& ground) {
  if (p.size <= 0) p.size = std::max(places_look::least_size, places_look::size_pixels * ground.pixel());
  if (p.thickness <= 0) p.thickness = places_look::thickness * p.size;
  if (p.roof <= 0) p.roof = places_look::roof * p.size;
  if (p.span <= 0) p.span = places_look::span * p.size;
  return p;
}

ArchPlaces find_arch_places(const Ground& ground, const field::CompiledField& field, const ArchParams& p,
                            std::size_t standing, Progress& progress) {
  return Search(ground, field, p, standing).run(progress);
}

RockTexture arch_texture(const Ground& ground, const ArchParams& p, double sign) {
  RockTexture t;
  t.geology = ground.site().geology;
  t.relief = sign * places_look::relief * p.weakness * p.size * places_look::relief_scale;
  t.unevenness = places_look::unevenness * p.roughness * p.size;
  t.wavelength = places_look::wavelength * p.size;
  t.amplitude = ground.site().amplitude;
  t.origin = ground.site().origin;
  t.seed = hash_combine(ground.site().seed, PlacesStream::rock);
  return t;
}

Bridge plan_bridge(const Ground& ground, const ArchParams& p, Vec3d a, Vec3d b, std::size_t index) {
  const double span = length(b - a);
  Random random(hash_combine(ground.site().seed, PlacesStream::bridges), std::uint64_t{index});
  return {a,
          b,
          places_look::rise * span,
          std::max(places_look::least_breadth, places_look::breadth * span),
          std::max(places_look::least_depth, places_look::depth * span),
          places_look::stray * span * random.uniform(-1, 1) * p.roughness};
}

}  // namespace tafoni::landforms::impl
