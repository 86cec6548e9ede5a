#include "tafoni/geology/impl/local.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_sphere {
namespace {

struct Params : impl::LocalParams {
  std::vector<double> position = {0, 0, 0};
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.numbers("position", &Params::position, "m", 0, -1e8, 1e8,
              "World x, y, z of the centre, or of several in turn, of which the nearest acts");
    impl::declare_local(t);
    return t;
  }();
  return params;
}

class Points {
 public:
  explicit Points(std::vector<Vec3d> points) : points_(std::move(points)) {}
  Vec3d nearest(Vec3d p) const {
    Vec3d best = points_.front();
    for (const Vec3d& q : points_)
      if (dot(p - q, p - q) < dot(p - best, p - best)) best = q;
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

GeologyPtr make(const Values& values, std::vector<GeologyPtr>, std::uint64_t seed) {
  Params p;
  assign(table().infos(), &p, values, "sphere");
  return std::make_shared<impl::Local<Points>>(p, Points(impl::triples(p.position, 1, "sphere")), seed);
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "sphere",
                .doc = "Adds resistance about places, or takes it away; 0 elsewhere",
                .source = "[Paris19 §4.2]",
                .params = table()},
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_sphere
