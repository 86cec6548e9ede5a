#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene {
namespace {

struct Params {
  double variation = 0.3, wander = 0.5, chamber_radius = 0, flatten = 0.6;
  std::int64_t chambers = 0;
};

const std::vector<ParamInfo>& params() {
  static const std::vector<ParamInfo> infos =
      ParamTable<Params>()
          .real("variation", &Params::variation, "", 0, 0.8, "How much the width varies along the passage")
          .real("wander", &Params::wander, "", 0, 3, "How far the passage strays from the curve, in radii")
          .integer("chambers", &Params::chambers, "", 0, 1000, "Rooms along the passage, evenly apart")
          .real("chamber_radius", &Params::chamber_radius, "m", 0, 1e4, "Radius of the rooms; 0: 2.2 radii")
          .real("flatten", &Params::flatten, "", 0.2, 1, "Height of the rooms in widths");
  return infos;
}

/// Smooth noise in [-1, 1] along a line, one value a unit.
double wave(const Random& random, double x) {
  const double whole = std::floor(x), t = x - whole, s = t * t * (3 - 2 * t);
  const auto at = [&](double i) {
    return static_cast<double>(random.at(static_cast<std::uint64_t>(static_cast<std::int64_t>(i))) >> 11) *
               0x1p-52 -
           1;
  };
  return at(whole) * (1 - s) + at(whole + 1) * s;
}

/// A room: overlapping balls in a flat disc, so that its plan is irregular and its floor level.
void chamber(Vec3d center, double radius, double flatten, Random random, Dab& dab) {
  const double ball = radius * flatten;
  dab.sphere(center, ball);
  const int around = 5 + static_cast<int>(random.below(4));
  const double turn = random.uniform(0, 6.283185307179586);
  for (int i = 0; i < around; ++i) {
    const double angle = turn + 6.283185307179586 * (i + random.uniform(-0.25, 0.25)) / around;
    const double r = ball * random.uniform(0.55, 0.95),
                 far = std::max(radius * random.uniform(0.8, 1.15) - r, 0.0);
    // The floors of all balls lie on about one level.
    dab.sphere(center + Vec3d{far * std::cos(angle), far * std::sin(angle), r - ball}, r);
  }
}

void apply(const Stroke& stroke, std::uint64_t seed, Dab& dab) {
  Params p;
  assign(params(), &p, stroke.values, "cave");
  const double room = p.chamber_radius > 0 ? p.chamber_radius : 2.2 * stroke.radius;
  if (stroke.points.size() == 1) return chamber(stroke.points[0], room, p.flatten, Random(seed, 4), dab);

  auto path = sample_path(stroke.points, true, 0.2 * stroke.radius);
  const Random sideways(seed, 1), up(seed, 2), width(seed, 3);
  const double step = 4 * stroke.radius;
  std::vector<double> covered(path.size(), 0);
  for (std::size_t i = 1; i < path.size(); ++i) covered[i] = covered[i - 1] + length(path[i] - path[i - 1]);
  const double whole = covered.back();
  const std::vector<Vec3d> straight = path;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3d ahead = straight[std::min(i + 1, path.size() - 1)] - straight[i > 0 ? i - 1 : 0];
    const Vec3d across = normalized(Vec3d{-ahead.y, ahead.x, 0});
    // The ends stay where they were asked for.
    const double free =
        std::min({covered[i] / step, (whole - covered[i]) / step, 1.0}) * p.wander * stroke.radius;
    path[i] += across * (free * wave(sideways, covered[i] / step)) +
               Vec3d{0, 0, 0.4 * free * wave(up, covered[i] / step)};
  }
  dab.tube(path, [&](double t) {
    return stroke.radius * (1 + p.variation * wave(width, t * whole / (1.5 * stroke.radius)));
  });
  for (std::int64_t c = 0; c < p.chambers; ++c) {
    const double at = whole * (static_cast<double>(c) + 1) / (static_cast<double>(p.chambers) + 1);
    const auto i = std::lower_bound(covered.begin(), covered.end(), at) - covered.begin();
    chamber(path[std::min(static_cast<std::size_t>(i), path.size() - 1)], room, p.flatten,
            Random(seed, 5 + static_cast<std::uint64_t>(c)), dab);
  }
}

}  // namespace

const BrushType& brush_cave() {
  static const BrushType type = [] {
    BrushType t;
    t.about.name = "cave";
    t.about.doc = "A passage of irregular width along a curve, with rooms; one point alone is a room";
    t.about.source = "[Paris19 §8.2]";
    t.about.params = params();
    t.max_points = 10000;
    t.apply = &apply;
    return t;
  }();
  return type;
}

}  // namespace tafoni::scene
