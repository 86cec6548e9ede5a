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

/// A course as a smooth line with even steps, its bed never rising downstream.
std::vector<Vec3d> smoothed(const std::vector<Vec3d>& line, double step, double over) {
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
      : ground_(ground), s_(settings), reach_(0.85 * settings.width), step_(0.38 * settings.width) {}

  double carve(field::CloudBuilder& cloud, const Streams::Course& course) {
    const auto line = smoothed(course.line, step_, std::max(2 * s_.width, 3 * ground_.pixel()));
    if (static_cast<double>(line.size()) * step_ < 4 * s_.width) return 0;
    std::vector<std::vector<Point>> made(line.size());
    parallel_blocks(std::ssize(line), 8, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        made[i] = section(line, i);
    });
    std::size_t opened = 0;
    for (const auto& points : made) {
      opened += !points.empty();
      for (const Point& p : points) add_point(cloud, p.at, p.radius, p.energy);
    }
    return static_cast<double>(opened) * step_;
  }

 private:
  struct Point {
    Vec3d at;
    double radius, energy;
  };

  double noise(Vec3d p, std::uint64_t stream) const {
    return 3.2 * (fbm(p, 2, hash_combine(s_.seed, stream)) - 0.5);
  }

  /// The points of one cross section, from the floor up.
  std::vector<Point> section(const std::vector<Vec3d>& line, std::size_t i) const {
    const auto n = line.size();
    const Vec3d at = line[i], before = line[i > 3 ? i - 3 : 0], after = line[std::min(i + 3, n - 1)];
    const Vec3d way = normalized(Vec3d{after.x - before.x, after.y - before.y, 0});
    const Vec3d aside{-way.y, way.x, 0};
    const double along = static_cast<double>(i) * step_, left = static_cast<double>(n - 1 - i) * step_;
    // Upstream the slot begins at a fall; where it leaves, it opens to whatever lies below.
    const double depth = s_.depth * smoothstep(0.0, 2.5 * s_.depth, left + 0.2 * s_.depth) *
                         (0.85 + 0.3 * noise({along / (12 * s_.width), 0, 9}, 1));
    std::vector<Point> points;
    const double floor = at.z - depth;
    for (double z = floor + 0.3 * s_.width; z < at.z + 0.7 * s_.width; z += step_) {
      const double up = std::clamp((z - floor) / std::max(depth, 1e-6), 0.0, 1.0);
      const Vec3d p = at + Vec3d{0, 0, z - at.z} + aside * offset(along, z, up);
      if (!ground_.usable(p)) continue;
      const double soft = erosion_effect(ground_.resistance(p), 1, s_.beta);
      // Wide chambers where water swirled, necks between; wider where beds are soft and towards the floor.
      const double swirl = noise({along / (3.5 * s_.width), z / (2.5 * s_.width), 4}, 2);
      const double half =
          0.5 * s_.width * std::clamp((0.7 + 0.5 * soft) * (1 + 0.3 * swirl) * (1.15 - 0.3 * up), 0.55, 1.5);
      // Where the slot leans or turns, its points lie farther apart.
      const double lean = (offset(along, z + step_, up) - offset(along, z, up)) / step_;
      const double turn = (offset(along + step_, z, up) - offset(along, z, up)) / step_;
      const double stretched = 1.1 * std::sqrt(1 + lean * lean + turn * turn);
      points.push_back({p, reach_, -stretched * sheet_energy(std::min(half, 0.8 * reach_), at.z - z)});
    }
    return points;
  }

  /// The walls of both sides sway together, in other places on other levels.
  double offset(double along, double z, double up) const {
    const double sway = noise({along / (5 * s_.width), z / (3.5 * s_.width), 17}, 3);
    const double flutes = noise({along / (2 * s_.width), z / (2.2 * s_.width), 31}, 4);
    return s_.winding * s_.width * (1.1 * sway + 0.22 * flutes) * (1 - smoothstep(0.7, 1.05, up));
  }

  /// Of each of a sheet of points `step` apart that opens it to `half` on both sides, `under` metres below
  /// the ground: together they sum up to E pi R^2 / (4 step^2) (1 - (x / R)^2)^4.
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
