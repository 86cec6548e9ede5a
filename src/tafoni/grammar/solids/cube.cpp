#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_cube {
namespace {

struct Cube final : Solid {
  Vec3d half() const { return {hx, hy, hz}; }
  double hx = 1, hy = 1, hz = 1;

  double distance(Vec3d p) const override {
    const Vec3d q{std::abs(p.x) - hx, std::abs(p.y) - hy, std::abs(p.z) - hz};
    const Vec3d out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
    return -length(out) - std::min(std::max({q.x, q.y, q.z}), 0.0);
  }
  Box3d bounds() const override { return impl::box_about_middle(half()); }
  std::vector<Bond> bonds() const override { return impl::six_sides(half()); }
};

const std::vector<ParamInfo>& table() {
  static const std::vector<ParamInfo> params =
      ParamTable<Cube>()
          .real("hx", &Cube::hx, "m", impl::least_size, impl::greatest_size, "Half its width along x")
          .real("hy", &Cube::hy, "m", impl::least_size, impl::greatest_size, "Half its width along y")
          .real("hz", &Cube::hz, "m", impl::least_size, impl::greatest_size, "Half its height");
  return params;
}

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "cube",
                .doc = "A cuboid; bonds in the middles of its six faces",
                .source = "[Zawadzki §2.5, fig. 6]",
                .params = table()},
      .make = [](const Values& sizes) { return impl::make_solid<Cube>(table(), sizes, "cube"); },
      .fit =
          [](Vec3d half) {
            return Values{{"hx", half.x}, {"hy", half.y}, {"hz", half.z}};
          },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_cube
