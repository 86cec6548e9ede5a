// A flat-capped cylinder from the anchor along an axis.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct Cylinder {
  static constexpr bool volumetric = true, has_extras = true;
  Axis axis;
  float base;
  Cylinder(const float* e, std::uint32_t) : axis(e), base(e[3]) {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    const Cylindrical<N> c(p, axis);
    return c.vector(max(c.radius - N(base), N(0.f)), c.along - clamp(c.along, N(0.f), N(axis.length)));
  }
};

#else

namespace tafoni::field::primitive_cylinder {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 0.5, dx = 0, dy = 0, dz = 10, base = 5;
  };
  static const PrimitiveType type{
      .about = {.name = "cylinder",
                .doc = "Constant inside a flat-capped cylinder that stands on the anchor, then falls off",
                .source = "[Paris19 §5.2]",
                .params =
                    ParamTable<Params>()
                        .real(
                            "radius", &Params::radius, "m", 1e-3, 1e4,
                            "Rounding: how far the body reaches beyond the shape that the other numbers give")
                        .real("dx", &Params::dx, "m", -1e4, 1e4, "Axis, from cap to cap, east")
                        .real("dy", &Params::dy, "m", -1e4, 1e4, "Axis, from cap to cap, north")
                        .real("dz", &Params::dz, "m", -1e4, 1e4, "Axis, from cap to cap, up")
                        .real("base", &Params::base, "m", 0, 1e4, "Radius of the caps")},
      .extras = 4,
      .volumetric = true,
      .extent =
          [](std::span<const float> e) {
            return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
          },
      .kernels = &impl::cylinder_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_cylinder

#endif
