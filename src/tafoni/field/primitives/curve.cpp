#include "tafoni/field/primitive.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/primitives/curve.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/primitive-inl.h"
#include "tafoni/field/impl/skeleton-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Curve {
  static constexpr bool volumetric = false, has_extras = true;
  const float* vertices;  ///< after the first, which is the anchor
  std::uint32_t count;
  Curve(const float* e, std::uint32_t n) : vertices(e), count(n) {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    Shortest<N> shortest(p);
    Vec3f from{0, 0, 0};
    for (std::uint32_t i = 0; i + 2 < count; i += 3) {
      const Vec3f to{vertices[i], vertices[i + 1], vertices[i + 2]};
      shortest.offer(from_segment(p - broadcast<N>(from), to - from));
      from = to;
    }
    return shortest.offset;
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
    t.about.name = "curve";
    t.about.doc = "Falls off from a curve, held as a chain of segments";
    t.about.source = "[Paris19 §5.2]";
    t.about.params =
        ParamTable<Params>()
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
