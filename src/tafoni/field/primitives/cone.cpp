// A cone, cut or not, on a flat base; in the half-plane through its axis it is a segment.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct Cone {
  static constexpr bool volumetric = true, has_extras = true;
  Axis axis;
  float base, tip;
  Cone(const float* e, std::uint32_t) : axis(e), base(e[3]), tip(e[4]) {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    const Cylindrical<N> c(p, axis);
    const N zero(0.f), above = c.along - N(axis.length);
    // In the half plane through the axis and p: the base, the tip and the side, a segment.
    Shortest<N> shortest({max(c.radius - N(base), zero), c.along, zero});
    shortest.offer({max(c.radius - N(tip), zero), above, zero});
    const Vec3N<N> corner{c.radius - N(base), c.along, zero};
    shortest.offer(from_segment(corner, Vec3f{tip - base, axis.length, 0}));
    const Lanes beyond = value_of(corner.x * N(axis.length) - c.along * N(tip - base));
    const Lanes outside = max(max(value_of(above), -value_of(c.along)),
                              max(beyond, value_of(c.radius - N(std::max(base, tip)))));
    return select(outside <= Lanes(0.f), Vec3N<N>{zero, zero, zero},
                  c.vector(shortest.offset.x, shortest.offset.y));
  }
};

#else

namespace tafoni::field::primitive_cone {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 0.5, dx = 0, dy = 0, dz = 10, base = 5, tip = 0;
  };
  static const PrimitiveType type{
      .about = {.name = "cone",
                .doc = "Constant inside a flat-capped cone that stands on the anchor, then falls off",
                .source = "[Paris19 §5.2]",
                .params =
                    ParamTable<Params>()
                        .real(
                            "radius", &Params::radius, "m", 1e-3, 1e4,
                            "Rounding: how far the body reaches beyond the shape that the other numbers give")
                        .real("dx", &Params::dx, "m", -1e4, 1e4, "Axis, from the base to the tip, east")
                        .real("dy", &Params::dy, "m", -1e4, 1e4, "Axis, from the base to the tip, north")
                        .real("dz", &Params::dz, "m", -1e4, 1e4, "Axis, from the base to the tip, up")
                        .real("base", &Params::base, "m", 0, 1e4, "Radius at the base")
                        .real("tip", &Params::tip, "m", 0, 1e4, "Radius at the tip; 0 for a point")},
      .extras = 5,
      .volumetric = true,
      .extent =
          [](std::span<const float> e) {
            return std::max(e[3], std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[4] * e[4]));
          },
      .kernels = &impl::cone_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_cone

#endif
