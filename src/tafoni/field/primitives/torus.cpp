// A circle about an axis, thickened to a tube.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

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

#else

namespace tafoni::field::primitive_torus {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 3, dx = 0, dy = 0, dz = 1, ring = 10;
  };
  static const PrimitiveType type{
      .about = {.name = "torus",
                .doc = "Constant inside a torus about the anchor, then falls off",
                .source = "[Paris19 §5.2]",
                .params = ParamTable<Params>()
                              .real("radius", &Params::radius, "m", 1e-3, 1e4, "Radius of the tube")
                              .real("dx", &Params::dx, "m", -1e4, 1e4, "Normal of its plane, east")
                              .real("dy", &Params::dy, "m", -1e4, 1e4, "Normal of its plane, north")
                              .real("dz", &Params::dz, "m", -1e4, 1e4, "Normal of its plane, up")
                              .real("ring", &Params::ring, "m", 0, 1e4,
                                    "Radius of the circle that its tube follows")},
      .extras = 4,
      .volumetric = true,
      .extent = [](std::span<const float> e) { return e[3]; },
      .kernels = &impl::torus_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_torus

#endif
