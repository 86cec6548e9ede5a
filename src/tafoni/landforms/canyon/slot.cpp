// Slot canyons: along the river's smoothed course, each cross section is a column of negative points from the
// floor to above the bed. Noise shifts the columns sideways (walls that overhang) and widens them (chambers);
// energies are such that the points together open the slot to its width.

#include "tafoni/landforms/canyon/slot.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::landforms::impl {
namespace {

enum class SlotStream : std::uint64_t { depth = 1, swirls = 2, sway = 3, flutes = 4 };

/// Chosen by eye; lengths are in widths of the slot where nothing else is said.
namespace slot_look {
// Reach of a point and the step between points, so that a sheet of them opens evenly.
constexpr double reach = 0.85, step = 0.38;
// The course is smoothed over so much, and over so many pixels of the terrain; a slot is so long at least.
constexpr double smoothing = 2, smoothing_pixels = 3, least_length = 4;
// Noise is stretched so that it fills about -1 to 1.
constexpr double noise_gain = 3.2;
// In depths: over how much of the course the slot deepens below the fall at its head, which is so far along
// already at the very end.
constexpr double head = 2.5, fall = 0.2;
// The depth varies about its mean by this share, from `mean_depth` up, over so long.
constexpr double mean_depth = 0.85, depth_change = 0.3, depth_wave = 12;
// A section begins so far above the floor and goes on so far above the bed, to open the ground there.
constexpr double lowest = 0.3, highest = 0.7;
// Swirls: their sizes along and up, and how much they widen the slot.
constexpr double swirl_along = 3.5, swirl_up = 2.5, swirl = 0.3;
// The width in the hardest rock and what the softest adds; at the floor and what is gone at the top; limits.
constexpr double hard = 0.7, soft = 0.5, floor_width = 1.15, narrowing = 0.3, narrowest = 0.55, widest = 1.5;
// Points are a little stronger than the sheet they stand for needs; a slot is not wider than this share of
// their reach.
constexpr double surplus = 1.1, most_open = 0.8;
// Sizes of the walls' sway and of the flutes on them, along and up, and how far they go at winding 1.
constexpr double sway_along = 5, sway_up = 3.5, sway = 1.1, flute_along = 2, flute_up = 2.2, flutes = 0.22;
// From this share of the depth up the slot turns upright, so that it meets the river's own course.
constexpr double upright = 0.7, all_upright = 1.05;
}  // namespace slot_look

/// A course as a smooth line with even steps, its bed never rising downstream.
std::vector<Vec3d> smooth_course(const std::vector<Vec3d>& line, double step, double over) {
  std::vector<Vec3d> even;
  double left = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec3d d = line[i + 1] - line[i];
    const double span = std::hypot(d.x, d.y);
    for (; left < span; left += step) even.push_back(line[i] + d * (left / span));
    left -= span;
  }
  const auto n = std::ssize(even);
  const auto reach = std::max<std::ptrdiff_t>(1, std::lround(over / step));
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Vec3d> sums(even.size() + 1);
    for (std::size_t i = 0; i < even.size(); ++i) sums[i + 1] = sums[i] + even[i];
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      const std::ptrdiff_t k = std::min({reach, i, n - 1 - i});
      even[i] = (sums[i + k + 1] - sums[i - k]) * (1.0 / static_cast<double>(2 * k + 1));
    }
  }
  for (std::size_t i = 1; i < even.size(); ++i) even[i].z = std::max(even[i].z, even[i - 1].z);
  return even;
}

class Slot {
 public:
  Slot(const Ground& ground, const SlotSettings& settings)
      : ground_(ground),
        s_(settings),
        reach_(slot_look::reach * settings.slot_width),
        step_(slot_look::step * settings.slot_width) {}

  double carve(field::CloudBuilder& cloud, const Streams::Course& course) {
    const auto line = smooth_course(
        course.line, step_,
        std::max(slot_look::smoothing * s_.slot_width, slot_look::smoothing_pixels * ground_.pixel()));
    if (static_cast<double>(line.size()) * step_ < slot_look::least_length * s_.slot_width) return 0;
    std::vector<std::vector<Point>> made(line.size());
    parallel_blocks(std::ssize(line), 8, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) made[i] = section(line, i);
    });
    int opened = 0;
    for (const auto& points : made) {
      opened += !points.empty();
      for (const Point& p : points) add_point(cloud, p.at, p.radius, p.energy);
    }
    return opened * step_;
  }

 private:
  struct Point {
    Vec3d at;
    double radius, energy;
  };

  double noise(Vec3d p, SlotStream stream) const {
    return slot_look::noise_gain * (fbm(p, 2, hash_combine(s_.seed, stream)) - 0.5);
  }

  /// The points of one cross section, from the floor up.
  std::vector<Point> section(const std::vector<Vec3d>& line, std::size_t i) const {
    const auto n = line.size();
    const Vec3d at = line[i], before = line[i > 3 ? i - 3 : 0], after = line[std::min(i + 3, n - 1)];
    const Vec3d way = normalized(Vec3d{after.x - before.x, after.y - before.y, 0});
    const Vec3d aside{-way.y, way.x, 0};
    const double along = static_cast<double>(i) * step_, left = static_cast<double>(n - 1 - i) * step_;
    // Upstream the slot begins at a fall; where it leaves, it opens to whatever lies below.
    const double depth =
        s_.slot_depth *
        smoothstep(0.0, slot_look::head * s_.slot_depth, left + slot_look::fall * s_.slot_depth) *
        (slot_look::mean_depth +
         slot_look::depth_change *
             noise({along / (slot_look::depth_wave * s_.slot_width), 0, 9}, SlotStream::depth));
    std::vector<Point> points;
    const double floor = at.z - depth;
    for (double z = floor + slot_look::lowest * s_.slot_width; z < at.z + slot_look::highest * s_.slot_width;
         z += step_) {
      const double up = std::clamp((z - floor) / std::max(depth, 1e-6), 0.0, 1.0);
      const Vec3d p = at + Vec3d{0, 0, z - at.z} + aside * offset(along, z, up);
      if (!ground_.usable(p)) continue;
      const double soft = erosion_effect(ground_.resistance(p), 1, s_.beta);
      // Wide chambers where water swirled, necks between; wider where beds are soft and towards the floor.
      const double swirl = noise(
          {along / (slot_look::swirl_along * s_.slot_width), z / (slot_look::swirl_up * s_.slot_width), 4},
          SlotStream::swirls);
      const double half =
          0.5 * s_.slot_width *
          std::clamp((slot_look::hard + slot_look::soft * soft) * (1 + slot_look::swirl * swirl) *
                         (slot_look::floor_width - slot_look::narrowing * up),
                     slot_look::narrowest, slot_look::widest);
      // Where the slot leans or turns, its points lie farther apart.
      const double lean = (offset(along, z + step_, up) - offset(along, z, up)) / step_;
      const double turn = (offset(along + step_, z, up) - offset(along, z, up)) / step_;
      const double stretched = slot_look::surplus * std::sqrt(1 + lean * lean + turn * turn);
      points.push_back(
          {p, reach_, -stretched * sheet_energy(std::min(half, slot_look::most_open * reach_), at.z - z)});
    }
    return points;
  }

  /// The walls of both sides sway together, in other places on other levels.
  double offset(double along, double z, double up) const {
    const double sway =
        noise({along / (slot_look::sway_along * s_.slot_width), z / (slot_look::sway_up * s_.slot_width), 17},
              SlotStream::sway);
    const double flutes = noise(
        {along / (slot_look::flute_along * s_.slot_width), z / (slot_look::flute_up * s_.slot_width), 31},
        SlotStream::flutes);
    return s_.winding * s_.slot_width * (slot_look::sway * sway + slot_look::flutes * flutes) *
           (1 - smoothstep(slot_look::upright, slot_look::all_upright, up));
  }

  /// The energy of each of a sheet of points `step` apart that opens it to `half` on both sides, `under`
  /// metres below the ground: together they sum up to E pi R^2 / (4 step^2) (1 - (x / R)^2)^4.
  double sheet_energy(double half, double under) const {
    const double rock = std::min(ground_.site().amplitude, std::max(under, 0.0) + half);
    const double q = 1 - (half / reach_) * (half / reach_);
    return rock * 4 * step_ * step_ / (3.14159265358979 * reach_ * reach_ * q * q * q * q);
  }

  const Ground& ground_;
  const SlotSettings& s_;
  double reach_, step_;
};

}  // namespace

double carve_slot(field::CloudBuilder& cloud, const Ground& ground, const Streams::Course& course,
                  const SlotSettings& settings) {
  return Slot(ground, settings).carve(cloud, course);
}

}  // namespace tafoni::landforms::impl
