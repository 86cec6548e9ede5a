#include "tafoni/field/primitive.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/primitives/segment.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/primitive-inl.h"
#include "tafoni/field/impl/skeleton-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Segment {
  static constexpr bool volumetric = false, has_extras = true;
  Vec3f end;
  Segment(const float* e, std::uint32_t) : end{e[0], e[1], e[2]} {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    return from_segment(p, end);
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
    t.about.name = "segment";
    t.about.doc = "Falls off from a line segment";
    t.about.source = "[Paris19 §5.2]";
    t.about.params =
        ParamTable<Params>()
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
