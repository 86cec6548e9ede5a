// A pyramid on a rectangular base, folded by symmetry to a quarter of it.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

struct Pyramid {
  static constexpr bool volumetric = true, has_extras = true;
  float hx, hy, height;
  Turn turn;
  Pyramid(const float* e, std::uint32_t) : hx(e[0]), hy(e[1]), height(e[2]), turn(e[3]) {}

  /// By symmetry in the quarter x, y >= 0: the base, the edge to the top, and a face where p stands over it.
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    const Vec3N<N> q = turn.to_body(p);
    const N zero(0.f), x = magnitude(q.x), y = magnitude(q.y);
    Shortest<N> shortest({max(x - N(hx), zero), max(y - N(hy), zero), q.z});
    shortest.offer(from_segment(Vec3N<N>{x - N(hx), y - N(hy), q.z}, Vec3f{-hx, -hy, height}));
    const Vec3N<N> none{N(1e18f), zero, zero};
    shortest.offer(over_face(Vec3N<N>{x, y, q.z}, hx, hy, none));
    const Vec3N<N> o_y = over_face(Vec3N<N>{y, x, q.z}, hy, hx, none);
    shortest.offer({o_y.y, o_y.x, o_y.z});
    const Lanes outside =
        max(max(value_of(above_face(x, q.z, hx)), value_of(above_face(y, q.z, hy))), -value_of(q.z));
    const Vec3N<N> o = select(outside <= Lanes(0.f), Vec3N<N>{zero, zero, zero}, shortest.offset);
    return turn.to_scene(Vec3N<N>{select(value_of(q.x) < Lanes(0.f), -o.x, o.x),
                                  select(value_of(q.y) < Lanes(0.f), -o.y, o.y), o.z});
  }

 private:
  /// Signed distance from the plane of the face that crosses the x axis at `half`.
  template <class N>
  TAFONI_LANES_INLINE N above_face(const N& x, const N& z, float half) const {
    const float inverse = 1 / std::sqrt(height * height + half * half);
    return ((x - N(half)) * N(height) + z * N(half)) * N(inverse);
  }
  /// From that face's nearest point where p's foot lies on the face, else `none`.
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> over_face(const Vec3N<N>& p, float half, float width,
                                         const Vec3N<N>& none) const {
    const float inverse = 1 / std::sqrt(height * height + half * half);
    const N d = above_face(p.x, p.z, half);
    const Lanes foot = value_of(p.z - d * N(half * inverse));
    const Lanes room = Lanes(width) - foot * Lanes(width / height) - value_of(p.y);
    const Lanes off = max(max(-foot, foot - Lanes(height)), max(-room, -value_of(d)));
    return select(off <= Lanes(0.f), Vec3N<N>{d * N(height * inverse), N(0.f), d * N(half * inverse)}, none);
  }
};

#else

namespace tafoni::field::primitive_pyramid {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 0.5, hx = 5, hy = 5, height = 10, turn = 0;
  };
  static const PrimitiveType type{
      .about = {.name = "pyramid",
                .doc = "Constant inside a pyramid whose base the anchor is the middle of, then falls off",
                .source = "[Paris19 §5.2]",
                .params =
                    ParamTable<Params>()
                        .real(
                            "radius", &Params::radius, "m", 1e-3, 1e4,
                            "Rounding: how far the body reaches beyond the shape that the other numbers give")
                        .real("hx", &Params::hx, "m", 0, 1e4, "Half the base's size along its own x")
                        .real("hy", &Params::hy, "m", 0, 1e4, "Half the base's size along its own y")
                        .real("height", &Params::height, "m", 1e-2, 1e4, "Height of the top above the base")
                        .real("turn", &Params::turn, "deg", -360, 360,
                              "Turn about the vertical, counter-clockwise from above")},
      .extras = 4,
      .volumetric = true,
      .extent = [](std::span<const float> e) { return std::max(std::sqrt(e[0] * e[0] + e[1] * e[1]), e[2]); },
      .kernels = &impl::pyramid_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_pyramid

#endif
