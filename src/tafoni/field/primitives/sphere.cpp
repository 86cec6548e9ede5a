#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct Sphere {
  static constexpr bool volumetric = true, has_extras = false;
  Sphere(const float*, std::uint32_t) {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    return p;
  }
};

#else

namespace tafoni::field::primitive_sphere {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 5;
  };
  static const PrimitiveType type{
      .about = {.name = "sphere",
                .doc = "Constant inside a ball, then falls off over the influence radius",
                .source = "[Paris19 §5.2]",
                .params = ParamTable<Params>().real("radius", &Params::radius, "m", 1e-3, 1e4,
                                                    "Radius of the ball")},
      .volumetric = true,
      .extent = [](std::span<const float>) { return 0.f; },
      .kernels = &impl::sphere_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_sphere

#endif
