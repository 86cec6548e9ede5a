#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_torus {
namespace {

struct Torus final : Solid {
  double ring = 1, tube = 0.4;

  double distance(Vec3d p) const override {
    const double r = impl::length_of(p.x, p.y), out = r - ring, from_circle = impl::length_of(out, p.z);
    // A tube wider than the ring meets itself on the axis, and what lies beyond is inside.
    if (tube > ring && ring * from_circle + tube * out < 0)
      return impl::length_of(r, std::abs(p.z) - std::sqrt(tube * tube - ring * ring));
    return tube - from_circle;
  }
  Box3d bounds() const override { return impl::box_about_middle({ring + tube, ring + tube, tube}); }
  /// Passages enter from outside, from above and below, but not from the hole, where there is no room.
  std::vector<Bond> bonds() const override {
    std::vector<Bond> out = impl::six_sides({ring + tube, ring + tube, tube});
    out[4].point.x = out[5].point.x = ring;
    return out;
  }
};

const std::vector<ParamInfo>& table() {
  static const std::vector<ParamInfo> params =
      ParamTable<Torus>()
          .real("ring", &Torus::ring, "m", impl::least_size, impl::greatest_size,
                "Radius of the circle that the tube follows")
          .real("tube", &Torus::tube, "m", impl::least_size, impl::greatest_size,
                "Radius of the tube; above that of the circle it fills the hole");
  return params;
}

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "torus",
                .doc = "A ring that lies flat; bonds on four sides of its outer rim, on top and below",
                .source = "[Zawadzki §2.1]",
                .params = table()},
      .make = [](const Values& sizes) { return impl::make_solid<Torus>(table(), sizes, "torus"); },
      .fit =
          [](Vec3d half) {
            const double wide = std::min(half.x, half.y), tube = std::min(half.z, 0.4 * wide);
            return Values{{"ring", wide - tube}, {"tube", tube}};
          },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_torus
