// Harder or softer rock along a curve through given places. The curve is cut into straight pieces; resistance
// falls off from the nearest of them.

#include "tafoni/geology/impl/local.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_curve {
namespace {

struct Params : impl::LocalParams {
  std::vector<double> position = {-60, 0, 0, 0, 20, 0, 60, 0, 0};
  bool smooth = true;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.numbers("position", &Params::position, "m", 0, -1e8, 1e8,
              "World x, y, z of the places that the curve passes through, in turn")
        .boolean("smooth", &Params::smooth,
                 "Whether the places are joined by a Catmull-Rom curve; straight pieces if not");
    impl::declare_local(t);
    return t;
  }();
  return params;
}

class Polyline {
 public:
  explicit Polyline(std::vector<Vec3d> points) : points_(std::move(points)) {}
  Vec3d nearest(Vec3d p) const {
    Vec3d best = points_.front();
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
      const Vec3d a = points_[i], along = points_[i + 1] - a;
      const double l2 = dot(along, along);
      const double t = l2 > 0 ? std::clamp(dot(p - a, along) / l2, 0.0, 1.0) : 0;
      const Vec3d q = a + along * t;
      if (dot(p - q, p - q) < dot(p - best, p - best)) best = q;
    }
    return best;
  }
  Box3d bounds() const {
    Box3d box;
    for (const Vec3d& q : points_) box.expand(q);
    return box;
  }

 private:
  std::vector<Vec3d> points_;
};

/// A uniform Catmull-Rom curve in straight pieces; at its ends it runs straight on.
std::vector<Vec3d> smooth_curve(const std::vector<Vec3d>& points) {
  constexpr int pieces = 12;  // between two places
  const std::ptrdiff_t last = std::ssize(points) - 1;
  const auto at = [&](std::ptrdiff_t k) {
    if (k < 0) return points[0] * 2.0 - points[1];
    if (k > last) return points[last] * 2.0 - points[last - 1];
    return points[k];
  };
  std::vector<Vec3d> out;
  for (std::ptrdiff_t i = 0; i < last; ++i) {
    const Vec3d a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
    for (int k = 0; k < pieces; ++k) {
      const double t = 1.0 * k / pieces;
      out.push_back(b + (c - a) * (0.5 * t) + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (0.5 * t * t) +
                    (b * 3.0 - a - c * 3.0 + d) * (0.5 * t * t * t));
    }
  }
  out.push_back(points.back());
  return out;
}

GeologyPtr make(const Values& values, std::vector<GeologyPtr>, std::uint64_t seed) {
  Params p;
  assign(table().infos(), &p, values, "curve");
  std::vector<Vec3d> points = impl::triples(p.position, 2, "curve");
  if (p.smooth) points = smooth_curve(points);
  return std::make_shared<impl::Local<Polyline>>(p, Polyline(std::move(points)), seed);
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "curve",
                .doc = "Adds resistance along a curve, or takes it away; 0 elsewhere",
                .source = "[Paris19 §4.2]",
                .params = table()},
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_curve
