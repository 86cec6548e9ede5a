#include "tafoni/field/primitive.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/primitives/segment.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/primitive-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Segment {
  static constexpr bool volumetric = false, has_extras = true;
  template <class N>
  static TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p, const float* end, std::uint32_t) {
    const float length2 = end[0] * end[0] + end[1] * end[1] + end[2] * end[2];
    const Vec3N<N> axis = broadcast<N>({end[0], end[1], end[2]});
    const N along = dot(p, axis) * N(1.f / std::max(length2, 1e-20f));
    return p - axis * min(max(along, N(0.f)), N(1.f));
  }
};

PrimitiveKernels segment_kernels() {
  return make_kernels<Segment>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(PrimitiveKernels, segment)
namespace {

struct Params {
  double radius = 5, dx = 10, dy = 0, dz = 0;
};

}  // namespace

const PrimitiveType& primitive_segment() {
  static const PrimitiveType type = [] {
    PrimitiveType t;
    t.name = "segment";
    t.doc = "Falls off from a line segment";
    t.source = "document 003, section 5.2";
    t.params = ParamTable<Params>()
                   .real("radius", &Params::radius, "m", 1e-3, 1e4, "Where the falloff reaches zero")
                   .real("dx", &Params::dx, "m", -1e4, 1e4, "End of the segment relative to its start, east")
                   .real("dy", &Params::dy, "m", -1e4, 1e4, "End of the segment relative to its start, north")
                   .real("dz", &Params::dz, "m", -1e4, 1e4, "End of the segment relative to its start, up");
    t.extras = 3;
    t.extent = [](std::span<const float> e) { return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]); };
    t.kernels = &kernels;
    return t;
  }();
  return type;
}

}  // namespace tafoni::field
#endif
