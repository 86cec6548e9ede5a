#include "tafoni/field/primitive.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/primitives/curve.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/primitive-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Curve {
  static constexpr bool volumetric = false, has_extras = true;
  /// The vertices after the first, which is the anchor.
  template <class N>
  static TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p, const float* vertices, std::uint32_t count) {
    Vec3N<N> best = p;
    N best2 = dot(p, p);
    float from[3] = {0, 0, 0};
    for (std::uint32_t i = 0; i + 2 < count; i += 3) {
      const float ax = vertices[i] - from[0], ay = vertices[i + 1] - from[1], az = vertices[i + 2] - from[2];
      const Vec3N<N> axis = broadcast<N>({ax, ay, az});
      const Vec3N<N> d = p - broadcast<N>({from[0], from[1], from[2]});
      const N along = dot(d, axis) * N(1.f / std::max(ax * ax + ay * ay + az * az, 1e-20f));
      const Vec3N<N> o = d - axis * min(max(along, N(0.f)), N(1.f));
      const N o2 = dot(o, o);
      const Mask nearer = o2 < best2;
      best = {select(nearer, o.x, best.x), select(nearer, o.y, best.y), select(nearer, o.z, best.z)};
      best2 = select(nearer, o2, best2);
      std::copy_n(vertices + i, 3, from);
    }
    return best;
  }
};

PrimitiveKernels curve_kernels() {
  return make_kernels<Curve>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(PrimitiveKernels, curve)
namespace {

struct Params {
  double radius = 5, dx = 10, dy = 0, dz = 0;
};

}  // namespace

const PrimitiveType& primitive_curve() {
  static const PrimitiveType type = [] {
    PrimitiveType t;
    t.name = "curve";
    t.doc = "Falls off from a curve, held as a chain of segments";
    t.source = "document 003, section 5.2";
    t.params = ParamTable<Params>()
                   .real("radius", &Params::radius, "m", 1e-3, 1e4, "Where the falloff reaches zero")
                   .real("dx", &Params::dx, "m", -1e4, 1e4, "A further vertex relative to the first, east")
                   .real("dy", &Params::dy, "m", -1e4, 1e4, "A further vertex relative to the first, north")
                   .real("dz", &Params::dz, "m", -1e4, 1e4, "A further vertex relative to the first, up");
    t.extras = 3;
    t.variable = true;
    t.extent = [](std::span<const float> e) {
      float most = 0;
      for (std::size_t i = 0; i + 2 < e.size(); i += 3)
        most = std::max(most, e[i] * e[i] + e[i + 1] * e[i + 1] + e[i + 2] * e[i + 2]);
      return std::sqrt(most);
    };
    t.kernels = &kernels;
    return t;
  }();
  return type;
}

}  // namespace tafoni::field
#endif
