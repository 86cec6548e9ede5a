// An ellipsoid: the nearest point of its surface is found by a fixed number of Newton steps.

#include "tafoni/field/impl/primitive_entry.h"

#if TAFONI_KERNELS  // the shape, once for every instruction set

/// The nearest surface point of p is s(t) = a^2 p / (t + a^2) for the t with |s / a| = 1. Newton's steps on
/// 1 / |s / a| - 1, which is nearly linear in t, rise to it from below. What they leave is projected onto the
/// surface, so that the offset is never shorter than the distance; `Ellipsoid` in the tests measures by how
/// much it is longer.
struct Ellipsoid {
  static constexpr bool volumetric = true, has_extras = true;
  static constexpr int steps = 5;
  Vec3f half;
  Turn turn;
  Ellipsoid(const float* e, std::uint32_t) : half{e[0], e[1], e[2]}, turn(e[3]) {}

  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> offset(const Vec3N<N>& p) const {
    const Vec3N<N> q = turn.to_body(p);
    const Vec3N<Lanes> plain{value_of(q.x), value_of(q.y), value_of(q.z)};
    Lanes t = below(plain);
    for (int i = 0; i < steps; ++i) t = newton(plain, t);
    // One step in N gives t its derivative.
    const N root = newton(q, N(t));
    const Vec3N<N> s{scaled(q.x, half.x, root), scaled(q.y, half.y, root), scaled(q.z, half.z, root)};
    const N inverse = N(1.f) / max(sqrt(dot(s, s)), N(no_length));
    const Vec3N<N> o{q.x - s.x * N(half.x) * inverse, q.y - s.y * N(half.y) * inverse,
                     q.z - s.z * N(half.z) * inverse};
    const Vec3N<Lanes> in{plain.x * Lanes(1 / half.x), plain.y * Lanes(1 / half.y),
                          plain.z * Lanes(1 / half.z)};
    const N zero(0.f);
    return turn.to_scene(select(dot(in, in) <= Lanes(1.f), Vec3N<N>{zero, zero, zero}, o));
  }

 private:
  /// s / a along one axis.
  template <class N>
  static TAFONI_LANES_INLINE N scaled(const N& x, float a, const N& t) {
    return x * N(a) / (t + N(a * a));
  }
  /// No more than the root, for p outside.
  TAFONI_LANES_INLINE Lanes below(const Vec3N<Lanes>& p) const {
    const Vec3N<Lanes> v{magnitude(p.x) * Lanes(half.x), magnitude(p.y) * Lanes(half.y),
                         magnitude(p.z) * Lanes(half.z)};
    const float most = std::max({half.x, half.y, half.z});
    const Lanes one =
        max(max(v.x - Lanes(half.x * half.x), v.y - Lanes(half.y * half.y)), v.z - Lanes(half.z * half.z));
    return max(max(one, sqrt(dot(v, v)) - Lanes(most * most)), Lanes(0.f));
  }
  template <class N>
  TAFONI_LANES_INLINE N newton(const Vec3N<N>& p, const N& t) const {
    const N sx = scaled(p.x, half.x, t), sy = scaled(p.y, half.y, t), sz = scaled(p.z, half.z, t);
    const N square = sx * sx + sy * sy + sz * sz, length = sqrt(square);
    const N slope = sx * sx / (t + N(half.x * half.x)) + sy * sy / (t + N(half.y * half.y)) +
                    sz * sz / (t + N(half.z * half.z));
    return max(t + square * (length - N(1.f)) / max(slope, N(1e-30f)), N(0.f));
  }
};

#else

namespace tafoni::field::primitive_ellipsoid {

const PrimitiveType& declaration() {
  struct Params {
    double radius = 0.5, hx = 5, hy = 5, hz = 5, turn = 0;
  };
  static const PrimitiveType type{
      .about = {.name = "ellipsoid",
                .doc = "Constant inside an ellipsoid about the anchor, then falls off",
                .source = "[Paris19 §5.2]",
                .params =
                    ParamTable<Params>()
                        .real(
                            "radius", &Params::radius, "m", 1e-3, 1e4,
                            "Rounding: how far the body reaches beyond the shape that the other numbers give")
                        .real("hx", &Params::hx, "m", 1e-2, 1e4, "Half its size along its own x")
                        .real("hy", &Params::hy, "m", 1e-2, 1e4, "Half its size along its own y")
                        .real("hz", &Params::hz, "m", 1e-2, 1e4, "Half its height")
                        .real("turn", &Params::turn, "deg", -360, 360,
                              "Turn about the vertical, counter-clockwise from above")},
      .extras = 4,
      .volumetric = true,
      .extent =
          [](std::span<const float> e) {
            return std::max({e[0], e[1], e[2]});
          },
      .kernels = &impl::ellipsoid_kernels,
  };
  return type;
}

}  // namespace tafoni::field::primitive_ellipsoid

#endif
