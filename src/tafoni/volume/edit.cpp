// Edits of a grid: a function of the position is evaluated over rows of samples within a tool's or a
// blast's reach, and each row's values are changed by it. Two plain loops a row, which compilers turn
// into vectors.

#include "tafoni/volume/edit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/volume/impl/tool_shape.h"

namespace tafoni::volume {
namespace {

void check(double amplitude, double radius, Vec3d center) {
  if (!(amplitude > 0) || !std::isfinite(amplitude))
    fail(ErrorKind::usage, "an edit's amplitude must be above 0 and finite, not {}", amplitude);
  if (!(radius > 0) || !std::isfinite(radius) || !std::isfinite(dot(center, center)))
    fail(ErrorKind::usage, "a radial edit needs a finite centre and a radius above 0, not {}", radius);
}

/// A ball outside of which an edit changes nothing.
struct Ball {
  Vec3d center;
  double radius;

  /// The samples of a row, so many per metre, that may lie in it, as [first, second).
  std::pair<int, int> within(Vec3d start, double per_metre, int n) const {
    const double y = start.y - center.y, z = start.z - center.z, left = radius * radius - y * y - z * z;
    if (!(left >= 0)) return {0, 0};
    const double half = std::sqrt(left) * per_metre, middle = (center.x - start.x) * per_metre;
    // A ball of a size beyond numbers reaches the whole row.
    const double first = middle - half - 1, last = middle + half + 2;
    return {first > 0 ? static_cast<int>(std::min<double>(first, n)) : 0,
            last < n ? static_cast<int>(std::max(last, 0.0)) : n};
  }
};
constexpr Ball everywhere{{}, std::numeric_limits<double>::infinity()};

constexpr int most_in_row = ScalarGrid::chunk_samples;  ///< samples that edit() gives at once

/// Gives samples of the box and the ball the values change(about(position), value).
template <class F, class G>
SampleBox edit_samples(ScalarGrid& grid, const Box3d& box, const Ball& ball, const F& about,
                       const G& change) {
  const GridFrame frame = grid.frame();
  const double per_metre = 1 / frame.spacing;
  return grid.edit(grid.samples_in(box), [&](Vec3i first, std::span<float> row) {
    const Vec3d start = frame.position(first);
    const auto [begin, end] = ball.within(start, per_metre, static_cast<int>(row.size()));
    const int from = first.x + begin, n = end - begin;
    double found[most_in_row];
    for (int i = 0; i < n; ++i)
      found[i] = about(Vec3d{frame.origin.x + frame.spacing * (from + i), start.y, start.z});
    float* values = row.data() + begin;
    for (int i = 0; i < n; ++i) values[i] = change(found[i], values[i]);
  });
}

template <class Solid>
Ball reach(const Solid&, double) {
  return everywhere;
}
Ball reach(const impl::Sphere& sphere, double amplitude) {
  return {sphere.center, sphere.radius + amplitude};
}

template <class Solid>
double distance(const Solid& solid, const Box3d&, Vec3d p) {
  return solid.distance(p);
}
/// A hull's bound of the distance falls slowly beyond a sharp corner; that to its bounds does not, and so the
/// edit ends where it must.
double distance(const impl::Hull& hull, const Box3d& bounds, Vec3d p) {
  const Vec3d over{std::max({bounds.lo.x - p.x, p.x - bounds.hi.x, 0.0}),
                   std::max({bounds.lo.y - p.y, p.y - bounds.hi.y, 0.0}),
                   std::max({bounds.lo.z - p.z, p.z - bounds.hi.z, 0.0})};
  return std::min(hull.distance(p), -length(over));
}

template <class Change>
SampleBox add_falloff(ScalarGrid& grid, Vec3d center, double radius, double amplitude, const Change& change) {
  const float limit = static_cast<float>(amplitude);
  const double scale = 1 / (radius * radius);
  return edit_samples(
      grid, Box3d{center, center}.grown(radius), {center, radius},
      [&](Vec3d p) {
        const Vec3d d = p - center;
        return dot(d, d) * scale;
      },
      [&](double squared, float v) {
        if (!(squared < 1)) return v;
        const auto now = static_cast<float>(v + change(squared));
        return std::min(std::max(now, std::min(v, -limit)), std::max(v, limit));
      });
}

}  // namespace

SampleBox apply(ScalarGrid& grid, const Tool& tool, Edit edit, double amplitude) {
  check(amplitude, 1, {});
  const Box3d bounds = tool.bounds(), box = bounds.grown(amplitude);
  return std::visit(
      [&](const auto& solid) {
        const Ball ball = reach(solid, amplitude);
        const auto limited = [&](Vec3d p) { return std::min(distance(solid, bounds, p), amplitude); };
        if (edit == Edit::add)
          return edit_samples(grid, box, ball, limited, [&](double d, float v) {
            return d > -amplitude ? std::max(v, static_cast<float>(d)) : v;
          });
        return edit_samples(grid, box, ball, limited, [&](double d, float v) {
          return d > -amplitude ? std::min(v, static_cast<float>(-d)) : v;
        });
      },
      tool.shape().solid);
}

SampleBox add_radial(ScalarGrid& grid, Vec3d center, double radius,
                     const std::function<double(double)>& change, double amplitude) {
  check(amplitude, radius, center);
  return add_falloff(grid, center, radius, amplitude,
                     [&](double squared) { return change(std::sqrt(squared)); });
}

SampleBox explode(ScalarGrid& grid, Vec3d center, double radius, double energy, double amplitude) {
  check(amplitude, radius, center);
  return add_falloff(grid, center, radius, amplitude, [&](double squared) {
    const double left = 1 - squared;
    return -energy * left * left * left;
  });
}

}  // namespace tafoni::volume
