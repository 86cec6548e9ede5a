#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_sphere {
namespace {

struct Sphere final : Solid {
  double radius = 1;

  double distance(Vec3d p) const override { return radius - length(p); }
  Box3d bounds() const override { return impl::box_about_middle({radius, radius, radius}); }
  std::vector<Bond> bonds() const override { return impl::six_sides({radius, radius, radius}); }
};

const std::vector<ParamInfo>& table() {
  static const std::vector<ParamInfo> params = ParamTable<Sphere>().real(
      "radius", &Sphere::radius, "m", impl::least_size, impl::greatest_size, "Radius of the sphere");
  return params;
}

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "sphere",
                .doc = "A sphere; bonds at its six poles",
                .source = "[Zawadzki §2.2]",
                .params = table()},
      .make = [](const Values& sizes) { return impl::make_solid<Sphere>(table(), sizes, "sphere"); },
      .fit =
          [](Vec3d half) {
            return Values{{"radius", std::min({half.x, half.y, half.z})}};
          },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_sphere
