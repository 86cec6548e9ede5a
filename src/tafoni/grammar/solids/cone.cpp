// An upright cone, whole or cut off. By symmetry its distance is that of a trapezium in the half plane of
// radius and height.

#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_cone {
namespace {

struct Cone final : Solid {
  double base = 1, tip = 0, height = 2;

  double distance(Vec3d p) const override {
    const double r = impl::length_of(p.x, p.y), half = height / 2;
    const double off_side = (height * (r - base) + (base - tip) * (p.z + half)) /
                            impl::length_of(height, base - tip);  // positive outside
    if (std::abs(p.z) <= half && off_side <= 0) return std::min(half - std::abs(p.z), -off_side);
    const double to_ends = std::min(impl::length_of(std::max(r - base, 0.0), p.z + half),
                                    impl::length_of(std::max(r - tip, 0.0), p.z - half));
    return -std::min(to_ends, impl::to_segment({r, 0, p.z}, {base, 0, -half}, {tip, 0, half}));
  }
  Box3d bounds() const override {
    const double wide = std::max(base, tip);
    return impl::box_about_middle({wide, wide, height / 2});
  }
  std::vector<Bond> bonds() const override {
    std::vector<Bond> out = impl::six_sides({(base + tip) / 2, (base + tip) / 2, height / 2});
    for (std::size_t i = 0; i < 4; ++i) {
      Vec3d& d = out[i].direction;
      d = normalized(Vec3d{height * d.x, height * d.y, base - tip});
    }
    if (tip == 0) out[4].direction = {};  // a point looks nowhere
    return out;
  }
};

const std::vector<ParamInfo>& table() {
  static const std::vector<ParamInfo> params =
      ParamTable<Cone>()
          .real("base", &Cone::base, "m", impl::least_size, impl::greatest_size, "Radius of its lower end")
          .real("tip", &Cone::tip, "m", 0, impl::greatest_size, "Radius of its upper end; 0 for a point")
          .real("height", &Cone::height, "m", impl::least_size, impl::greatest_size,
                "Height from end to end, along z");
  return params;
}

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "cone",
                .doc = "An upright cone, whole or cut off; bonds in the middles of its ends and on four "
                       "sides; that of a point has no direction",
                .source = "[Zawadzki §2.1]",
                .params = table()},
      .make = [](const Values& sizes) { return impl::make_solid<Cone>(table(), sizes, "cone"); },
      .fit =
          [](Vec3d half) {
            return Values{{"base", std::min(half.x, half.y)}, {"tip", 0.0}, {"height", 2 * half.z}};
          },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_cone
