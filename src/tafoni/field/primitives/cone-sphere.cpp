// The hull of two balls of different radii.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct ConeSphere {
  static constexpr bool volumetric = true, has_extras = true;
  Axis axis;
  float base, from = 0, to, slope = 0, lean = 0;
  /// The ball about s in [from, to] on the axis has radius base - slope s; the balls touch the hull's side
  /// where it leans back by `lean` metres a metre off the axis.
  ConeSphere(const float* e, std::uint32_t) : axis(e), base(e[3]), to(axis.length) {
    // A hull that is all but a disc would have no side to lean on.
    const float tip = e[4], most = 0.9999f * axis.length;
    if (std::fabs(base - tip) < most) {
      slope = (base - tip) / axis.length;
      lean = slope / std::sqrt(1 - slope * slope);
    } else {
      // One ball holds the other.
      (base > tip ? to : from) = base > tip ? 0 : axis.length;
      base = std::max(base, tip);
    }
  }
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    const Cylindrical<N> c(p, axis);
    const N s = clamp(c.along - c.radius * N(lean), N(from), N(to));
    const Vec3N<N> v = p - c.axis * s;
    const N length = max(sqrt(dot(v, v)), N(no_length));
    return v * max(N(1.f) - (N(base) - N(slope) * s) / length, N(0.f));
  }
};

#else

namespace tafoni::field::primitive_cone_sphere {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 0.5, dx = 0, dy = 0, dz = 10, base = 5, tip = 2;
  };
  static const PrimitiveType type{
      .about = {.name = "cone-sphere",
                .doc = "Constant inside the hull of two balls, the first at the anchor, then falls off",
                .source = "[Paris19 §5.2]",
                .params =
                    ParamTable<Params>()
                        .real(
                            "radius", &Params::radius, "m", 1e-3, 1e4,
                            "Rounding: how far the body reaches beyond the shape that the other numbers give")
                        .real("dx", &Params::dx, "m", -1e4, 1e4,
                              "The second ball's centre relative to the first's, east")
                        .real("dy", &Params::dy, "m", -1e4, 1e4,
                              "The second ball's centre relative to the first's, north")
                        .real("dz", &Params::dz, "m", -1e4, 1e4,
                              "The second ball's centre relative to the first's, up")
                        .real("base", &Params::base, "m", 0, 1e4, "Radius of the ball at the anchor")
                        .real("tip", &Params::tip, "m", 0, 1e4, "Radius of the ball at the other end")},
      .extras = 5,
      .volumetric = true,
      .extent =
          [](std::span<const float> e) {
            return std::max(e[3], std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + e[4]);
          },
      .kernels = &impl::cone_sphere_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_cone_sphere

#endif
