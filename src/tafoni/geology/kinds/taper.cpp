// Beds that thin out or swell about a place: a position asks the child at the elevation that its rock had
// before.

#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_taper {
namespace {

struct Params {
  std::vector<double> position = {0, 0, 0};
  double radius = 150;
  double height = 40;
  double ratio = 0.4;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.numbers("position", &Params::position, "m", 3, -1e8, 1e8,
              "World position where the beds are thinnest, or thickest")
        .real("radius", &Params::radius, "m", 0.01, 1e6,
              "Horizontal distance from the position at which the beds are as they were")
        .real("height", &Params::height, "m", 0.01, 1e5,
              "How far above and below the position beds are compressed; those beyond only follow")
        .real("ratio", &Params::ratio, "", 0.02, 50,
              "Thickness of the beds at the position as a share of their own; above 1 they swell");
    return t;
  }();
  return params;
}

class Node final : public impl::BatchGeology {
 public:
  Node(const Params& p, GeologyPtr rock) : p_(p), rock_(std::move(rock)) {}

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      std::array<Vec3d, impl::noise_block> from;
      for (std::size_t i = 0; i < n; ++i) from[i] = source(points[begin + i]);
      rock_->raws(std::span(from).first(n), out.subspan(begin, n));
    });
  }

 private:
  /// Where the rock at p came from. With k = 1 - (1 - ratio) g(horizontal distance / radius) and z from the
  /// position's elevation: z / k within +-k height, beyond z +- (1 - k) height. One to one for each x, y.
  Vec3d source(Vec3d p) const {
    const double x = p.x - p_.position[0], y = p.y - p_.position[1], z = p.z - p_.position[2];
    const double g = impl::falloff(std::sqrt(x * x + y * y) / p_.radius);
    if (g == 0) return p;
    const double k = 1 - (1 - p_.ratio) * g;
    if (std::abs(z) < k * p_.height) return {p.x, p.y, p_.position[2] + z / k};
    return {p.x, p.y, p.z + (1 - k) * std::copysign(p_.height, z)};
  }

  Params p_;
  GeologyPtr rock_;
};

GeologyPtr make(const Values& values, std::vector<GeologyPtr> children, std::uint64_t) {
  Params p;
  assign(table().infos(), &p, values, "taper");
  return std::make_shared<Node>(p, std::move(children[0]));
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "taper",
                .doc = "Compresses or swells the beds of its child about a place",
                .source = "[Paris19 §4.3]",
                .params = table()},
      .min_children = 1,
      .max_children = 1,
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_taper
