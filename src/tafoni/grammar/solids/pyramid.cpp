// A pyramid on a rectangle. Inside, the nearest side counts; outside, the nearest of the base and of two
// triangles, since all four quarters are alike.

#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_pyramid {
namespace {

/// Distance to a triangle, both sides.
double to_triangle(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d n = cross(b - a, c - a);
  const auto within = [&](Vec3d from, Vec3d to) { return dot(cross(to - from, p - from), n) >= 0; };
  if (within(a, b) && within(b, c) && within(c, a)) return std::abs(dot(p - a, n)) / length(n);
  return std::min({impl::to_segment(p, a, b), impl::to_segment(p, b, c), impl::to_segment(p, c, a)});
}

struct Pyramid final : Solid {
  double hx = 1, hy = 1, height = 2;

  double distance(Vec3d at) const override {
    // It is the same in each quarter.
    const double half = height / 2;
    const Vec3d p{std::abs(at.x), std::abs(at.y), at.z};
    const double off_x = (height * (p.x - hx) + hx * (p.z + half)) / impl::length_of(height, hx),
                 off_y = (height * (p.y - hy) + hy * (p.z + half)) / impl::length_of(height, hy),
                 below = -half - p.z;
    const double off = std::max({off_x, off_y, below});
    if (off <= 0) return -off;
    const Vec3d apex{0, 0, half}, corner{hx, hy, -half};
    const double to_base =
        impl::length_of(impl::length_of(std::max(p.x - hx, 0.0), std::max(p.y - hy, 0.0)), below);
    return -std::min({to_base, to_triangle(p, {hx, -hy, -half}, corner, apex),
                      to_triangle(p, corner, {-hx, hy, -half}, apex)});
  }
  Box3d bounds() const override { return impl::box_about_middle({hx, hy, height / 2}); }
  std::vector<Bond> bonds() const override {
    const double x = hx * 2 / 3, y = hy * 2 / 3, z = -height / 6;
    const Vec3d east = normalized(Vec3d{height, 0, hx}), north = normalized(Vec3d{0, height, hy});
    return {{{x, 0, z}, east},
            {{-x, 0, z}, {-east.x, 0, east.z}},
            {{0, y, z}, north},
            {{0, -y, z}, {0, -north.y, north.z}},
            {{0, 0, -height / 2}, {0, 0, -1}},
            {{0, 0, height / 2}, {}}};
  }
};

const std::vector<ParamInfo>& table() {
  static const std::vector<ParamInfo> params =
      ParamTable<Pyramid>()
          .real("hx", &Pyramid::hx, "m", impl::least_size, impl::greatest_size, "Half its base along x")
          .real("hy", &Pyramid::hy, "m", impl::least_size, impl::greatest_size, "Half its base along y")
          .real("height", &Pyramid::height, "m", impl::least_size, impl::greatest_size,
                "Height from its base to its point");
  return params;
}

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "pyramid",
                .doc = "A pyramid on a rectangle; bonds in the middles of its five faces, and at its point, "
                       "without direction",
                .source = "[Zawadzki §2.1]",
                .params = table()},
      .make = [](const Values& sizes) { return impl::make_solid<Pyramid>(table(), sizes, "pyramid"); },
      .fit =
          [](Vec3d half) {
            return Values{{"hx", half.x}, {"hy", half.y}, {"height", 2 * half.z}};
          },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_pyramid
