// The number types SIMD kernels are written over: Lanes (up to eight floats) and Dual (Lanes with a
// gradient). Included once for every instruction set by hwy/foreach_target.h, hence the toggle instead of
// pragma once.
#if defined(TAFONI_MATH_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TAFONI_MATH_LANES_INL_H_
#undef TAFONI_MATH_LANES_INL_H_
#else
#define TAFONI_MATH_LANES_INL_H_
#endif

#include <cstdint>

#include <hwy/highway.h>

#include "tafoni/math/vec.h"

// Forced inlining is what makes kernels fast and instrumented ones take minutes to compile.
#ifndef TAFONI_LANES_INLINE
#if HWY_IS_ASAN || HWY_IS_TSAN || HWY_IS_MSAN
#define TAFONI_LANES_INLINE inline
#else
#define TAFONI_LANES_INLINE HWY_INLINE
#endif
#endif

HWY_BEFORE_NAMESPACE();
namespace tafoni {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes at most, so that a brick's row of samples is one vector on AVX2 and AVX-512 alike.
using FloatTag = hn::CappedTag<float, 8>;
using IntTag = hn::RebindToSigned<FloatTag>;
inline constexpr FloatTag float_tag;
inline constexpr IntTag int_tag;
using Mask = hn::Mask<FloatTag>;

struct Ints {
  hn::Vec<IntTag> v;
  Ints() = default;
  TAFONI_LANES_INLINE Ints(hn::Vec<IntTag> a) : v(a) {}
  TAFONI_LANES_INLINE Ints(std::int32_t a) : v(hn::Set(int_tag, a)) {}
  static TAFONI_LANES_INLINE Ints load(const std::int32_t* p) { return hn::LoadU(int_tag, p); }
  friend TAFONI_LANES_INLINE Ints operator+(Ints a, Ints b) { return hn::Add(a.v, b.v); }
  friend TAFONI_LANES_INLINE Ints operator-(Ints a, Ints b) { return hn::Sub(a.v, b.v); }
  friend TAFONI_LANES_INLINE Ints operator*(Ints a, Ints b) { return hn::Mul(a.v, b.v); }
  friend TAFONI_LANES_INLINE Ints operator^(Ints a, Ints b) { return hn::Xor(a.v, b.v); }
  friend TAFONI_LANES_INLINE Ints operator&(Ints a, Ints b) { return hn::And(a.v, b.v); }
};
template <int bits>
TAFONI_LANES_INLINE Ints shift_right_unsigned(Ints a) {
  const hn::RebindToUnsigned<IntTag> u;
  return hn::BitCast(int_tag, hn::ShiftRight<bits>(hn::BitCast(u, a.v)));
}
template <int bits>
TAFONI_LANES_INLINE Ints shift_left(Ints a) {
  return hn::ShiftLeft<bits>(a.v);
}

struct Lanes {
  hn::Vec<FloatTag> v;
  Lanes() = default;
  TAFONI_LANES_INLINE Lanes(hn::Vec<FloatTag> a) : v(a) {}
  TAFONI_LANES_INLINE Lanes(float a) : v(hn::Set(float_tag, a)) {}
  static TAFONI_LANES_INLINE Lanes load(const float* p) { return hn::LoadU(float_tag, p); }
  TAFONI_LANES_INLINE void store(float* p) const { hn::StoreU(v, float_tag, p); }
  friend TAFONI_LANES_INLINE Lanes operator+(Lanes a, Lanes b) { return hn::Add(a.v, b.v); }
  friend TAFONI_LANES_INLINE Lanes operator-(Lanes a, Lanes b) { return hn::Sub(a.v, b.v); }
  friend TAFONI_LANES_INLINE Lanes operator-(Lanes a) { return hn::Neg(a.v); }
  friend TAFONI_LANES_INLINE Lanes operator*(Lanes a, Lanes b) { return hn::Mul(a.v, b.v); }
  friend TAFONI_LANES_INLINE Lanes operator/(Lanes a, Lanes b) { return hn::Div(a.v, b.v); }
  friend TAFONI_LANES_INLINE Mask operator<(Lanes a, Lanes b) { return hn::Lt(a.v, b.v); }
  friend TAFONI_LANES_INLINE Mask operator<=(Lanes a, Lanes b) { return hn::Le(a.v, b.v); }
  friend TAFONI_LANES_INLINE Mask operator>(Lanes a, Lanes b) { return hn::Gt(a.v, b.v); }
  friend TAFONI_LANES_INLINE Mask operator>=(Lanes a, Lanes b) { return hn::Ge(a.v, b.v); }
};
TAFONI_LANES_INLINE std::size_t lane_count() {
  return hn::Lanes(float_tag);
}
TAFONI_LANES_INLINE Lanes to_lanes(Ints a) {
  return hn::ConvertTo(float_tag, a.v);
}
/// a * b + c, fused where the target has it.
TAFONI_LANES_INLINE Lanes mul_add(Lanes a, Lanes b, Lanes c) {
  return hn::MulAdd(a.v, b.v, c.v);
}
/// c - a * b
TAFONI_LANES_INLINE Lanes neg_mul_add(Lanes a, Lanes b, Lanes c) {
  return hn::NegMulAdd(a.v, b.v, c.v);
}
TAFONI_LANES_INLINE Lanes min(Lanes a, Lanes b) {
  return hn::Min(a.v, b.v);
}
TAFONI_LANES_INLINE Lanes max(Lanes a, Lanes b) {
  return hn::Max(a.v, b.v);
}
TAFONI_LANES_INLINE Lanes sqrt(Lanes a) {
  return hn::Sqrt(a.v);
}
TAFONI_LANES_INLINE Lanes floor(Lanes a) {
  return hn::Floor(a.v);
}
TAFONI_LANES_INLINE Lanes abs(Lanes a) {
  return hn::Abs(a.v);
}
TAFONI_LANES_INLINE Lanes select(Mask m, Lanes yes, Lanes no) {
  return hn::IfThenElse(m, yes.v, no.v);
}
TAFONI_LANES_INLINE Ints select(Mask m, Ints yes, Ints no) {
  return hn::BitCast(int_tag, hn::IfThenElse(m, hn::BitCast(float_tag, yes.v), hn::BitCast(float_tag, no.v)));
}
TAFONI_LANES_INLINE Ints truncated(Lanes a) {
  return hn::ConvertTo(int_tag, a.v);
}
TAFONI_LANES_INLINE Lanes value_of(Lanes a) {
  return a;
}

/// A value with its partial derivatives along x, y and z (forward-mode automatic differentiation).
struct Dual {
  Lanes v, x, y, z;
  Dual() = default;
  TAFONI_LANES_INLINE Dual(Lanes value) : v(value), x(0.f), y(0.f), z(0.f) {}
  TAFONI_LANES_INLINE Dual(float value) : Dual(Lanes(value)) {}
  TAFONI_LANES_INLINE Dual(Lanes value, Lanes dx, Lanes dy, Lanes dz) : v(value), x(dx), y(dy), z(dz) {}
  friend TAFONI_LANES_INLINE Dual operator+(Dual a, Dual b) {
    return {a.v + b.v, a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend TAFONI_LANES_INLINE Dual operator-(Dual a, Dual b) {
    return {a.v - b.v, a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend TAFONI_LANES_INLINE Dual operator-(Dual a) { return {-a.v, -a.x, -a.y, -a.z}; }
  friend TAFONI_LANES_INLINE Dual operator*(Dual a, Dual b) {
    return {a.v * b.v, a.x * b.v + a.v * b.x, a.y * b.v + a.v * b.y, a.z * b.v + a.v * b.z};
  }
  friend TAFONI_LANES_INLINE Dual operator/(Dual a, Dual b) {
    const Lanes q = a.v / b.v;
    return {q, (a.x - q * b.x) / b.v, (a.y - q * b.y) / b.v, (a.z - q * b.z) / b.v};
  }
  friend TAFONI_LANES_INLINE Mask operator<(Dual a, Dual b) { return a.v < b.v; }
  friend TAFONI_LANES_INLINE Mask operator>(Dual a, Dual b) { return a.v > b.v; }
};
TAFONI_LANES_INLINE Lanes value_of(const Dual& a) {
  return a.v;
}
TAFONI_LANES_INLINE Dual select(Mask m, Dual a, Dual b) {
  return {select(m, a.v, b.v), select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
// The value parts repeat the plain operations exactly, so that a gradient query returns the very same f.
TAFONI_LANES_INLINE Dual mul_add(Dual a, Dual b, Dual c) {
  const Dual d = a * b + c;
  return {mul_add(a.v, b.v, c.v), d.x, d.y, d.z};
}
TAFONI_LANES_INLINE Dual neg_mul_add(Dual a, Dual b, Dual c) {
  const Dual d = c - a * b;
  return {neg_mul_add(a.v, b.v, c.v), d.x, d.y, d.z};
}
TAFONI_LANES_INLINE Dual min(Dual a, Dual b) {
  return select(a.v <= b.v, a, b);
}
TAFONI_LANES_INLINE Dual max(Dual a, Dual b) {
  return select(a.v >= b.v, a, b);
}
/// The derivative at zero is taken as zero.
TAFONI_LANES_INLINE Dual sqrt(Dual a) {
  const Lanes r = sqrt(a.v);
  const Lanes k = select(r > Lanes(0.f), Lanes(0.5f) / r, Lanes(0.f));
  return {r, a.x * k, a.y * k, a.z * k};
}

template <class N>
struct Vec3N {
  N x, y, z;
  friend TAFONI_LANES_INLINE Vec3N operator+(const Vec3N& a, const Vec3N& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend TAFONI_LANES_INLINE Vec3N operator-(const Vec3N& a, const Vec3N& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend TAFONI_LANES_INLINE Vec3N operator*(const Vec3N& a, const N& s) {
    return {a.x * s, a.y * s, a.z * s};
  }
};
template <class N>
TAFONI_LANES_INLINE Vec3N<N> broadcast(Vec3f a) {
  return {N(a.x), N(a.y), N(a.z)};
}
template <class N>
TAFONI_LANES_INLINE N dot(const Vec3N<N>& a, const Vec3N<N>& b) {
  return mul_add(a.z, b.z, mul_add(a.y, b.y, a.x * b.x));
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni
HWY_AFTER_NAMESPACE();

#endif
