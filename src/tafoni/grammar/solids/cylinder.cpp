#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_cylinder {
namespace {

struct Cylinder final : Solid {
  double radius = 1, height = 2;

  double distance(Vec3d p) const override {
    const double r = impl::length_of(p.x, p.y) - radius, z = std::abs(p.z) - height / 2;
    return -impl::length_of(std::max(r, 0.0), std::max(z, 0.0)) - std::min(std::max(r, z), 0.0);
  }
  Box3d bounds() const override { return impl::box_about_middle({radius, radius, height / 2}); }
  std::vector<Bond> bonds() const override { return impl::six_sides({radius, radius, height / 2}); }
};

const std::vector<ParamInfo>& table() {
  static const std::vector<ParamInfo> params =
      ParamTable<Cylinder>()
          .real("radius", &Cylinder::radius, "m", impl::least_size, impl::greatest_size,
                "Radius of its round side")
          .real("height", &Cylinder::height, "m", impl::least_size, impl::greatest_size,
                "Height from end to end, along z");
  return params;
}

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "cylinder",
                .doc = "An upright cylinder; bonds in the middles of its ends and on four sides",
                .source = "[Zawadzki §2.2]",
                .params = table()},
      .make = [](const Values& sizes) { return impl::make_solid<Cylinder>(table(), sizes, "cylinder"); },
      .fit =
          [](Vec3d half) {
            return Values{{"radius", std::min(half.x, half.y)}, {"height", 2 * half.z}};
          },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_cylinder
