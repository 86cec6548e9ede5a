// An added arch is a tube along a parabola from foot to foot, thick at the feet and thinnest at the crown. A
// carved one is a bundle of level tubes through the wall, side by side and one above another, that fill the
// section of an arch: upright walls and half a circle on them.
#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/math/whole.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::brush_arch {
namespace {

enum class Stream : std::uint64_t { bow = 1 };

// The least number of pieces of the rib, how many more there are for each radius of its way, and at most: it
// must look round at the crown, and a thin, long one must not take forever.
constexpr int least_steps = 24;
constexpr double steps_per_radius = 2, most_steps = 4000;

struct Params {
  double height = 12, depth = 30, feet = 1.5;
};

const std::vector<ParamInfo>& params() {
  static const std::vector<ParamInfo> infos =
      ParamTable<Params>()
          .real("height", &Params::height, "m", 0.1, 1e4,
                "How high the arch's inner crown, or the top of the opening, is above the line of the feet")
          .real("depth", &Params::depth, "m", 0.1, 1e4,
                "How far the opening reaches through the wall, half to either side of the feet")
          .only("where mode is carve", {{"mode", std::string("carve")}})
          .real("feet", &Params::feet, "", 0.2, 10,
                "Radius of the feet in radii of the crown: above 1 the arch widens downwards")
          .only("where mode is add", {{"mode", std::string("add")}});
  return infos;
}

/// A rib of rock from foot to foot, as a parabola stands on its ends; thinnest at the crown.
void rib(const Stroke& stroke, const Params& p, std::uint64_t seed, Dab& dab) {
  const Vec3d a = stroke.points[0], b = stroke.points[1];
  const double rise = p.height + stroke.radius;
  Random random(seed, Stream::bow);
  const Vec3d across = normalized(Vec3d{a.y - b.y, b.x - a.x, 0});
  const double bow = stroke.roughness * stroke.radius * random.uniform(-1, 1);
  std::vector<Vec3d> path;
  const double way = length(b - a) + rise;
  const int steps = least_steps + floor_to(std::min(steps_per_radius * way / stroke.radius, most_steps));
  for (double i = 0; i <= steps; ++i) {
    const double t = i / steps, crown = 4 * t * (1 - t);
    path.push_back(a + (b - a) * t + Vec3d{0, 0, rise * crown} + across * (bow * crown));
  }
  dab.tube(path, [&](double t) {
    const double away = std::abs(2 * t - 1);
    return stroke.radius * (1 + (p.feet - 1) * away * away);
  });
}

/// A passage across the line of the feet with the section of an arch: half a circle on upright walls.
void opening(const Stroke& stroke, const Params& p, Dab& dab) {
  const Vec3d a = stroke.points[0], b = stroke.points[1];
  const Vec3d span = b - a;
  const double half = 0.5 * std::hypot(span.x, span.y);
  if (!(half > 0)) fail(ErrorKind::usage, "arch: the feet stand on one another; an opening needs a width");
  const Vec3d middle = (a + b) * 0.5, sideways = normalized(Vec3d{span.x, span.y, 0});
  const Vec3d through{-sideways.y, sideways.x, 0};
  const double bore = std::min({stroke.radius, half, 0.5 * p.height});
  const double spring = std::max(p.height - half, bore);  // where the walls end and the vault begins
  const auto run = [&](double x, double z, double r) {
    const Vec3d center = middle + sideways * x + Vec3d{0, 0, z};
    const Vec3d ends[] = {center - through * (0.5 * p.depth), center + through * (0.5 * p.depth)};
    dab.tube(sample_path(ends, false, path_spacing * r), [r](double) { return r; });
  };
  const double reach = half - bore, top = p.height - bore;
  check_stroke_size((1 + 2 * reach / bore) * std::max(p.height / bore, 1.0) * (1 + 2 * p.depth / bore));
  const int columns = reach > 0 ? 1 + ceil_to(2 * reach / bore) : 1;
  for (int i = 0; i < columns; ++i) {
    const double x = columns > 1 ? -reach + 2 * reach * i / (columns - 1) : 0;
    const double vault = reach > 0 ? std::sqrt(std::max(1 - (x / reach) * (x / reach), 0.0)) : 1;
    const double ceiling = spring + (top - spring) * vault;
    const int rows = 1 + ceil_to(std::max(ceiling - bore, 0.0) / bore);
    for (int k = 0; k < rows; ++k)
      run(x, rows > 1 ? bore + (ceiling - bore) * k / (rows - 1) : ceiling, bore);
  }
}

void apply(const Stroke& stroke, std::uint64_t seed, Dab& dab) {
  Params p;
  assign(params(), &p, stroke.values, "arch");
  if (stroke.adds())
    rib(stroke, p, seed, dab);
  else
    opening(stroke, p, dab);
}

}  // namespace

const BrushType& declaration() {
  static const BrushType type{
      .about = {.name = "arch",
                .doc = "Between two feet: a rock arch (add), or an arched opening through a wall (carve)",
                .source = "[Paris19 §8.2]",
                .params = params()},
      .min_points = 2,
      .max_points = 2,
      .apply = apply,
  };
  return type;
}

}  // namespace tafoni::scene::brush_arch
