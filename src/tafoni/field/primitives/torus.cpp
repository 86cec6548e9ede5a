#include "tafoni/field/primitive.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/primitives/torus.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/primitive-inl.h"
#include "tafoni/field/impl/skeleton-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Torus {
  static constexpr bool volumetric = true, has_extras = true;
  Axis normal;
  Vec3f side;  ///< where a point on the normal looks for the circle
  float ring;
  Torus(const float* e, std::uint32_t) : normal(e), ring(e[3]) {
    const Vec3f n = normal.unit;
    side = normalized(std::fabs(n.z) < 0.7f ? Vec3f{n.y, -n.x, 0} : Vec3f{0, n.z, -n.y});
  }
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    const Cylindrical<N> c(p, normal);
    const Vec3N<N> out =
        select(value_of(c.radius) > Lanes(1e-6f), c.vector(N(1.f), N(0.f)), broadcast<N>(side));
    return p - out * N(ring);
  }
};

PrimitiveKernels torus_kernels() {
  return make_kernels<Torus>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(PrimitiveKernels, torus)
namespace {

struct Params {
  double radius = 3, dx = 0, dy = 0, dz = 1, ring = 10;
};

}  // namespace

const PrimitiveType& primitive_torus() {
  static const PrimitiveType type = [] {
    PrimitiveType t;
    t.about.name = "torus";
    t.about.doc = "Constant inside a torus about the anchor, then falls off";
    t.about.source = "[Paris19 §5.2]";
    t.about.params =
        ParamTable<Params>()
            .real("radius", &Params::radius, "m", 1e-3, 1e4, "Radius of the tube")
            .real("dx", &Params::dx, "m", -1e4, 1e4, "Normal of its plane, east")
            .real("dy", &Params::dy, "m", -1e4, 1e4, "Normal of its plane, north")
            .real("dz", &Params::dz, "m", -1e4, 1e4, "Normal of its plane, up")
            .real("ring", &Params::ring, "m", 0, 1e4, "Radius of the circle that its tube follows");
    t.extras = 4;
    t.volumetric = true;
    t.extent = [](std::span<const float> e) { return e[3]; };
    t.kernels = &kernels;
    return t;
  }();
  return type;
}

}  // namespace tafoni::field
#endif
