#include "tafoni/scene/sculpt/brush.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"

namespace tafoni::scene {
namespace {

// Steps of a curve are of unlike length: the longest is taken to be so many times the chord between two
// points divided by the number of steps.
constexpr double longest_step = 1.5;
constexpr double most_steps = 1e5;  // between two points, so that one in the wrong place takes no minutes

// The balls of a tube stand half a radius apart, its points `path_spacing`.
constexpr double spaces_a_ball = 0.5 / path_spacing;

}  // namespace

void check_stroke_size(double balls) {
  constexpr double most = 2e6;  // a quarter of a gigabyte
  if (!(balls <= most))
    fail(ErrorKind::usage,
         "it takes about {:.2g} balls, and at most {:.0f} million are made; give a larger radius or a "
         "shorter way",
         balls, most / 1e6);
}

const BrushType& find_brush(std::string_view name) {
  return tafoni::find(all_brushes(), name, "brush");
}

std::vector<ParamInfo> params_of_brush(const BrushType& brush, const Values& values) {
  std::vector<ParamInfo> out = brush.about.params;
  if (!brush.more) return out;
  for (ParamInfo& info : brush.more(values)) out.push_back(std::move(info));
  return out;
}

std::vector<Vec3d> sample_path(std::span<const Vec3d> points, bool smooth, double spacing) {
  std::vector<Vec3d> out;
  const auto steps_after = [&](std::ptrdiff_t i) {
    const double steps = std::ceil(longest_step * length(points[i + 1] - points[i]) / spacing);
    return std::clamp(steps, 1.0, most_steps);
  };
  double balls = 1;
  for (std::ptrdiff_t i = 0; i + 1 < std::ssize(points); ++i)
    balls += std::min(steps_after(i), 1 + length(points[i + 1] - points[i]) / (spaces_a_ball * spacing));
  check_stroke_size(balls);
  const auto at = [&](std::ptrdiff_t i) {
    return points[std::clamp<std::ptrdiff_t>(i, 0, std::ssize(points) - 1)];
  };
  for (std::ptrdiff_t i = 0; i + 1 < std::ssize(points); ++i) {
    const Vec3d p0 = at(i - 1), p1 = at(i), p2 = at(i + 1), p3 = at(i + 2);
    const Vec3d a = p1 * 3.0 - p0 - p2 * 3.0 + p3, b = p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3, c = p2 - p0;
    const double steps = steps_after(i);
    for (double k = 0; k < steps; ++k) {
      const double t = k / steps;
      out.push_back(smooth ? p1 + ((a * t + b) * t + c) * (0.5 * t) : p1 + (p2 - p1) * t);
    }
  }
  out.push_back(points.back());
  return out;
}

}  // namespace tafoni::scene
