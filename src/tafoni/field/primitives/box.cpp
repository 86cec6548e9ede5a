#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct Box {
  static constexpr bool volumetric = true, has_extras = true;
  Vec3f half;
  Turn turn;
  Box(const float* e, std::uint32_t) : half{e[0], e[1], e[2]}, turn(e[3]) {}
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    const Vec3N<N> q = turn.to_body(p);
    return turn.to_scene(Vec3N<N>{q.x - clamp(q.x, N(-half.x), N(half.x)),
                                  q.y - clamp(q.y, N(-half.y), N(half.y)),
                                  q.z - clamp(q.z, N(-half.z), N(half.z))});
  }
};

#else

namespace tafoni::field::primitive_box {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 0.5, hx = 5, hy = 5, hz = 5, turn = 0;
  };
  static const PrimitiveType type{
      .about = {.name = "box",
                .doc = "Constant inside a box about the anchor, then falls off",
                .source = "[Paris19 §5.2]",
                .params =
                    ParamTable<Params>()
                        .real(
                            "radius", &Params::radius, "m", 1e-3, 1e4,
                            "Rounding: how far the body reaches beyond the shape that the other numbers give")
                        .real("hx", &Params::hx, "m", 0, 1e4, "Half its size along its own x")
                        .real("hy", &Params::hy, "m", 0, 1e4, "Half its size along its own y")
                        .real("hz", &Params::hz, "m", 0, 1e4, "Half its height")
                        .real("turn", &Params::turn, "deg", -360, 360,
                              "Turn about the vertical, counter-clockwise from above")},
      .extras = 4,
      .volumetric = true,
      .extent = [](std::span<const float> e) { return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]); },
      .kernels = &impl::box_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_box

#endif
