#include "tafoni/field/primitive.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/primitives/cylinder.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/primitive-inl.h"
#include "tafoni/field/impl/skeleton-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

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

PrimitiveKernels cylinder_kernels() {
  return make_kernels<Cylinder>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(PrimitiveKernels, cylinder)
namespace {

struct Params {
  double radius = 0.5, dx = 0, dy = 0, dz = 10, base = 5;
};

}  // namespace

const PrimitiveType& primitive_cylinder() {
  static const PrimitiveType type = [] {
    PrimitiveType t;
    t.about.name = "cylinder";
    t.about.doc = "Constant inside a flat-capped cylinder that stands on the anchor, then falls off";
    t.about.source = "[Paris19 §5.2]";
    t.about.params =
        ParamTable<Params>()
            .real("radius", &Params::radius, "m", 1e-3, 1e4,
                  "Rounding: how far the body reaches beyond the shape that the other numbers give")
            .real("dx", &Params::dx, "m", -1e4, 1e4, "Axis, from cap to cap, east")
            .real("dy", &Params::dy, "m", -1e4, 1e4, "Axis, from cap to cap, north")
            .real("dz", &Params::dz, "m", -1e4, 1e4, "Axis, from cap to cap, up")
            .real("base", &Params::base, "m", 0, 1e4, "Radius of the caps");
    t.extras = 4;
    t.volumetric = true;
    t.extent = [](std::span<const float> e) {
      return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
    };
    t.kernels = &kernels;
    return t;
  }();
  return type;
}

}  // namespace tafoni::field
#endif
