// A line segment from the anchor.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct Segment {
  static constexpr bool volumetric = false, has_extras = true;
  Vec3f end;
  Segment(const float* e, std::uint32_t) : end{e[0], e[1], e[2]} {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    return from_segment(p, end);
  }
};

#else

namespace tafoni::field::primitive_segment {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 5, dx = 10, dy = 0, dz = 0;
  };
  static const PrimitiveType type{
      .about =
          {.name = "segment",
           .doc = "Falls off from a line segment",
           .source = "[Paris19 §5.2]",
           .params =
               ParamTable<Params>()
                   .real("radius", &Params::radius, "m", 1e-3, 1e4, "Where the falloff reaches zero")
                   .real("dx", &Params::dx, "m", -1e4, 1e4, "End of the segment relative to its start, east")
                   .real("dy", &Params::dy, "m", -1e4, 1e4, "End of the segment relative to its start, north")
                   .real("dz", &Params::dz, "m", -1e4, 1e4, "End of the segment relative to its start, up")},
      .extras = 3,
      .extent = [](std::span<const float> e) { return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]); },
      .kernels = &impl::segment_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_segment

#endif
