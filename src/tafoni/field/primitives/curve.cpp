// A chain of segments from the anchor through any number of vertices.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

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

#else

namespace tafoni::field::primitive_curve {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 5, dx = 10, dy = 0, dz = 0;
  };
  static const PrimitiveType type{
      .about =
          {.name = "curve",
           .doc = "Falls off from a curve, held as a chain of segments",
           .source = "[Paris19 §5.2]",
           .params =
               ParamTable<Params>()
                   .real("radius", &Params::radius, "m", 1e-3, 1e4, "Where the falloff reaches zero")
                   .real("dx", &Params::dx, "m", -1e4, 1e4, "A further vertex relative to the first, east")
                   .real("dy", &Params::dy, "m", -1e4, 1e4, "A further vertex relative to the first, north")
                   .real("dz", &Params::dz, "m", -1e4, 1e4, "A further vertex relative to the first, up")},
      .extras = 3,
      .variable = true,
      .extent =
          [](std::span<const float> e) {
            float most = 0;
            for (std::size_t i = 0; i + 2 < e.size(); i += 3)
              most = std::max(most, e[i] * e[i] + e[i + 1] * e[i + 1] + e[i + 2] * e[i + 2]);
            return std::sqrt(most);
          },
      .kernels = &impl::curve_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_curve

#endif
