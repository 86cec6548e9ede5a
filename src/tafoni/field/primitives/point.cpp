#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct Point {
  static constexpr bool volumetric = false, has_extras = false;
  Point(const float*, std::uint32_t) {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    return p;
  }
};

#else

namespace tafoni::field::primitive_point {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 5;
  };
  static const PrimitiveType type{
      .about = {.name = "point",
                .doc = "Falls off from a point",
                .source = "[Paris19 §5.2]",
                .params = ParamTable<Params>().real("radius", &Params::radius, "m", 1e-3, 1e4,
                                                    "Where the falloff reaches zero")},
      .extent = [](std::span<const float>) { return 0.f; },
      .kernels = &impl::point_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_point

#endif
