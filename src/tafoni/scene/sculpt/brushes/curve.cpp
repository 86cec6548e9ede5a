#include "tafoni/core/error.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene {
namespace {

struct Params {
  bool smooth = true;
  double end_radius = 0;
};

const std::vector<ParamInfo>& params() {
  static const std::vector<ParamInfo> infos =
      ParamTable<Params>()
          .boolean("smooth", &Params::smooth, "A Catmull-Rom curve through the points; else straight lines")
          .real("end_radius", &Params::end_radius, "m", 0, 1e4,
                "Radius at the last point; 0 keeps the radius");
  return infos;
}

void apply(const Stroke& stroke, std::uint64_t, Dab& dab) {
  Params p;
  assign(params(), &p, stroke.values, "curve");
  const double end = p.end_radius > 0 ? p.end_radius : stroke.radius;
  const auto path = sample_path(stroke.points, p.smooth, 0.2 * std::min(stroke.radius, end));
  dab.tube(path, [&](double t) { return stroke.radius + (end - stroke.radius) * t; });
}

}  // namespace

const BrushType& brush_curve() {
  static const BrushType type = [] {
    BrushType t;
    t.about.name = "curve";
    t.about.doc = "A rough tunnel or ridge along a curve";
    t.about.source = "[Paris19 §5.2, §8.2]";
    t.about.params = params();
    t.min_points = 2;
    t.max_points = 10000;
    t.apply = &apply;
    return t;
  }();
  return type;
}

}  // namespace tafoni::scene
