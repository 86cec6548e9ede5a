#include "tafoni/field/primitive.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/primitives/sphere.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/primitive-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Sphere {
  static constexpr bool volumetric = true, has_extras = false;
  Sphere(const float*, std::uint32_t) {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    return p;
  }
};

PrimitiveKernels sphere_kernels() {
  return make_kernels<Sphere>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(PrimitiveKernels, sphere)
namespace {

struct Params {
  double radius = 5;
};

}  // namespace

const PrimitiveType& primitive_sphere() {
  static const PrimitiveType type = [] {
    PrimitiveType t;
    t.about.name = "sphere";
    t.about.doc = "Constant inside a ball, then falls off over the influence radius";
    t.about.source = "[Paris19 §5.2]";
    t.about.params =
        ParamTable<Params>().real("radius", &Params::radius, "m", 1e-3, 1e4, "Radius of the ball");
    t.volumetric = true;
    t.extent = [](std::span<const float>) { return 0.f; };
    t.kernels = &kernels;
    return t;
  }();
  return type;
}

}  // namespace tafoni::field
#endif
