#include "tafoni/core/error.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::brush_curve {
namespace {

struct Params {
  bool smooth = true;
  double end_radius = 0;
};

const std::vector<ParamInfo>& params() {
  static const std::vector<ParamInfo> infos =
      ParamTable<Params>()
          .boolean("smooth", &Params::smooth,
                   "Draws a Catmull-Rom curve through the points; false joins them by straight lines")
          .real("end_radius", &Params::end_radius, "m", 0, 1e4,
                "Radius at the last point, to which the radius goes evenly; 0 keeps the stroke's radius");
  return infos;
}

void apply(const Stroke& stroke, std::uint64_t, Dab& dab) {
  Params p;
  assign(params(), &p, stroke.values, "curve");
  const double end = p.end_radius > 0 ? p.end_radius : stroke.radius;
  const auto path = sample_path(stroke.points, p.smooth, path_spacing * std::min(stroke.radius, end));
  dab.tube(path, [&](double t) { return stroke.radius + (end - stroke.radius) * t; });
}

}  // namespace

const BrushType& declaration() {
  static const BrushType type{
      .about = {.name = "curve",
                .doc = "A rough tunnel or ridge along a curve",
                .source = "[Paris19 §5.2, §8.2]",
                .params = params()},
      .min_points = 2,
      .max_points = 10000,
      .apply = apply,
  };
  return type;
}

}  // namespace tafoni::scene::brush_curve
