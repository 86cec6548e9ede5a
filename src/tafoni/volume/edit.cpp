#include "tafoni/volume/edit.h"

#include <algorithm>
#include <cmath>

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

/// change(position, value) at every sample of the box gives its new value.
template <class F>
SampleBox edit_samples(ScalarGrid& grid, const Box3d& box, const F& change) {
  const GridFrame frame = grid.frame();
  return grid.edit(grid.samples_in(box), [&](Vec3i first, std::span<float> row) {
    const Vec3d start = frame.position(first);
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] = change(
          Vec3d{frame.origin.x + frame.spacing * (first.x + static_cast<int>(i)), start.y, start.z}, row[i]);
  });
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
  const float most = static_cast<float>(amplitude);
  const double scale = 1 / (radius * radius);
  return edit_samples(grid, Box3d{center, center}.grown(radius), [&](Vec3d p, float v) {
    const Vec3d d = p - center;
    const double squared = dot(d, d) * scale;
    if (!(squared < 1)) return v;
    const auto now = static_cast<float>(v + change(squared));
    return std::min(std::max(now, std::min(v, -most)), std::max(v, most));
  });
}

}  // namespace

SampleBox apply(ScalarGrid& grid, const Tool& tool, Edit edit, double amplitude) {
  check(amplitude, 1, {});
  const Box3d bounds = tool.bounds(), box = bounds.grown(amplitude);
  return std::visit(
      [&](const auto& solid) {
        const auto limited = [&](Vec3d p) { return std::min(distance(solid, bounds, p), amplitude); };
        if (edit == Edit::add)
          return edit_samples(grid, box, [&](Vec3d p, float v) {
            const double d = limited(p);
            return d > -amplitude ? std::max(v, static_cast<float>(d)) : v;
          });
        return edit_samples(grid, box, [&](Vec3d p, float v) {
          const double d = limited(p);
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
