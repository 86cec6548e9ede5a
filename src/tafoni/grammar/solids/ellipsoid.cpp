// An ellipsoid by its true distance: Newton's steps find the nearest point of the surface.

#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_ellipsoid {
namespace {

struct Ellipsoid final : Solid {
  Vec3d half() const { return {hx, hy, hz}; }
  double hx = 1, hy = 1, hz = 1;

  // The nearest point is a^2 p / (t + a^2), where t is the greatest root of F(t) = sum (a p / (t + a^2))^2
  // - 1. F falls and is convex right of its last pole, so that Newton's steps from where F >= 0 never
  // overshoot.
  double distance(Vec3d p) const override {
    const double a[3] = {hx, hy, hz}, at[3] = {p.x, p.y, p.z};
    double q[3], t = -1e300, inside = 0;
    const double least = std::min({hx, hy, hz}) * std::min({hx, hy, hz});
    for (int i = 0; i < 3; ++i) {
      q[i] = std::max(std::abs(at[i]), 1e-9 * a[i]);
      t = std::max(t, a[i] * q[i] - a[i] * a[i]);
      inside += q[i] * q[i] / (a[i] * a[i]);
    }
    constexpr int most = 100;  // steps; a few are enough but right beside a pole
    for (int step = 0; step < most; ++step) {
      double f = -1, slope = 0;
      for (int i = 0; i < 3; ++i) {
        const double s = t + a[i] * a[i], r = a[i] * q[i] / s;
        f += r * r;
        slope += 2 * r * r / s;
      }
      const double further = f / slope;
      t += further;
      // What is left is the square of it, as a share of the way to the pole.
      if (std::abs(further) <= 1e-7 * (t + least)) break;
    }
    double square = 0;
    for (int i = 0; i < 3; ++i) {
      const double d = q[i] * t / (t + a[i] * a[i]);
      square += d * d;
    }
    return inside < 1 ? std::sqrt(square) : -std::sqrt(square);
  }
  Box3d bounds() const override { return impl::box_about_middle(half()); }
  std::vector<Bond> bonds() const override { return impl::six_sides(half()); }
};

const std::vector<ParamInfo>& table() {
  static const std::vector<ParamInfo> params =
      ParamTable<Ellipsoid>()
          .real("hx", &Ellipsoid::hx, "m", impl::least_size, impl::greatest_size, "Half its width along x")
          .real("hy", &Ellipsoid::hy, "m", impl::least_size, impl::greatest_size, "Half its width along y")
          .real("hz", &Ellipsoid::hz, "m", impl::least_size, impl::greatest_size, "Half its height");
  return params;
}

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "ellipsoid",
                .doc = "An ellipsoid, by its true distance; bonds at its six poles",
                .source = "[Zawadzki §2.1]",
                .params = table()},
      .make = [](const Values& sizes) { return impl::make_solid<Ellipsoid>(table(), sizes, "ellipsoid"); },
      .fit =
          [](Vec3d half) {
            return Values{{"hx", half.x}, {"hy", half.y}, {"hz", half.z}};
          },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_ellipsoid
