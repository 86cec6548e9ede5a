// Simplex noise over SIMD lanes, with its analytic gradient. See lanes-inl.h for the toggle.
#if defined(TAFONI_MATH_NOISE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TAFONI_MATH_NOISE_INL_H_
#undef TAFONI_MATH_NOISE_INL_H_
#else
#define TAFONI_MATH_NOISE_INL_H_
#endif

#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni {
namespace HWY_NAMESPACE {

/// Where noise is taken: q in units of the wavelength plus an integer translation of the simplex lattice.
/// Translating space by 3m (m integer) moves the skewed lattice by 3m + (m.x + m.y + m.z), again integer, so
/// a far position splits exactly into cells to hash and a small remainder in float.
struct NoiseCell {
  Ints x, y, z;
};
TAFONI_LANES_INLINE NoiseCell noise_cell(Ints mx, Ints my, Ints mz) {
  const Ints sum = mx + my + mz;
  return {Ints(3) * mx + sum, Ints(3) * my + sum, Ints(3) * mz + sum};
}

namespace noise_detail {

// Coordinates of the lattice are hashed by a multiple of each; that of a neighbour is one multiple more.
inline constexpr std::int32_t hash_x = 0x27d4eb2d, hash_y = 0x165667b1, hash_z = 0x1b873593;
inline constexpr auto sign_bit = static_cast<std::int32_t>(0x80000000u);

/// `value` where the mask is set, else 0.
TAFONI_LANES_INLINE Ints masked(Mask mask, std::int32_t value) {
  return hn::IfThenElseZero(hn::RebindMask(int_tag, mask), hn::Set(int_tag, value));
}
/// `v`, negative where `sign` is the sign bit.
TAFONI_LANES_INLINE Lanes flipped(Lanes v, Ints sign) {
  return hn::BitCast(float_tag, (Ints(hn::BitCast(int_tag, v.v)) ^ sign).v);
}

/// One corner's t^4 (g . d) with t = 1/2 - |d|^2 (so that the kernel is C^2 and vanishes before the next
/// simplex), and its gradient when `grad` is given. g is one of the twelve edge directions of a cube: one
/// axis is left out, the first of the others has one sign, the second another.
TAFONI_LANES_INLINE Lanes corner(Lanes dx, Lanes dy, Lanes dz, Ints h, Vec3N<Lanes>* grad) {
  h = h * Ints(0x2c1b3c6d);
  h = h ^ shift_right_unsigned<15>(h);
  h = h * Ints(0x297a2d39);
  const Ints byte = h & Ints(0x00ff0000);  // in thirds: x, y or z is left out
  const Mask no_x = hn::RebindMask(float_tag, hn::Lt(byte.v, Ints(86 << 16).v));
  const Mask no_z = hn::RebindMask(float_tag, hn::Gt(byte.v, Ints(170 << 16).v));
  const Ints first = h & Ints(sign_bit), second = shift_left<1>(h) & Ints(sign_bit);
  const Lanes t = max(neg_mul_add(dz, dz, neg_mul_add(dy, dy, neg_mul_add(dx, dx, Lanes(0.5f)))), Lanes(0.f));
  const Lanes t2 = t * t, t4 = t2 * t2;
  const Lanes gd = flipped(select(no_x, dy, dx), first) + flipped(select(no_z, dy, dz), second);
  if (grad) {
    const Lanes zero(0.f), a = flipped(t4, first), b = flipped(t4, second);
    const Lanes k8 = Lanes(-8.f) * t2 * t * gd;
    grad->x = grad->x + mul_add(k8, dx, select(no_x, zero, a));
    grad->y = grad->y + mul_add(k8, dy, select(no_x, a, select(no_z, b, zero)));
    grad->z = grad->z + mul_add(k8, dz, select(no_z, zero, b));
  }
  return t4 * gd;
}

}  // namespace noise_detail

/// The greatest sum of the four corners, with the best gradient at each, is 1 / 76.88 (maximised numerically
/// over the simplex), so that the noise stays strictly inside [-1, 1].
inline constexpr float simplex_scale = 76.8f;

/// Simplex noise in [-1, 1]; adds its gradient with respect to q to `grad` when given.
TAFONI_LANES_INLINE Lanes simplex_lanes(Lanes x, Lanes y, Lanes z, const NoiseCell& cell, std::uint32_t seed,
                                        Vec3N<Lanes>* grad) {
  const Lanes skew = (x + y + z) * Lanes(1.f / 3);
  const Lanes fi = floor(x + skew), fj = floor(y + skew), fk = floor(z + skew);
  const Lanes unskew = (fi + fj + fk) * Lanes(1.f / 6);
  const Lanes x0 = x - fi + unskew, y0 = y - fj + unskew, z0 = z - fk + unskew;
  const Ints i = truncated(fi) + cell.x, j = truncated(fj) + cell.y, k = truncated(fk) + cell.z;
  // Rank of each coordinate decides the walk through the simplex: first along the greatest, last along the
  // least.
  const Mask xy = x0 >= y0, yz = y0 >= z0, xz = x0 >= z0;
  const Mask i1 = hn::And(xy, xz), j1 = hn::AndNot(xy, yz), k1 = hn::Not(hn::Or(i1, j1));
  const Mask i2 = hn::Or(xy, xz), k2 = hn::Not(hn::And(xz, yz)), j2 = hn::Not(hn::And(i2, k2));
  using namespace noise_detail;
  const Ints hx = i * Ints(hash_x), hy = j * Ints(hash_y), hz = k * Ints(hash_z);
  const Ints s(static_cast<std::int32_t>(seed));
  const Lanes zero(0.f), one(1.f);
  Vec3N<Lanes> g{zero, zero, zero};
  Vec3N<Lanes>* gp = grad ? &g : nullptr;
  constexpr float c = 1.f / 6;
  const auto next = [&](Mask di, Mask dj, Mask dk, float back) {
    const Ints h = (hx + masked(di, hash_x)) ^ (hy + masked(dj, hash_y)) ^ (hz + masked(dk, hash_z)) ^ s;
    return corner(x0 - select(di, one, zero) + Lanes(back), y0 - select(dj, one, zero) + Lanes(back),
                  z0 - select(dk, one, zero) + Lanes(back), h, gp);
  };
  Lanes n = corner(x0, y0, z0, hx ^ hy ^ hz ^ s, gp);
  n = n + next(i1, j1, k1, c);
  n = n + next(i2, j2, k2, 2 * c);
  n = n + corner(x0 - Lanes(0.5f), y0 - Lanes(0.5f), z0 - Lanes(0.5f),
                 (hx + Ints(hash_x)) ^ (hy + Ints(hash_y)) ^ (hz + Ints(hash_z)) ^ s, gp);
  if (grad) {
    grad->x = mul_add(g.x, Lanes(simplex_scale), grad->x);
    grad->y = mul_add(g.y, Lanes(simplex_scale), grad->y);
    grad->z = mul_add(g.z, Lanes(simplex_scale), grad->z);
  }
  return n * Lanes(simplex_scale);
}

namespace noise_detail {

template <bool with_gradient>
TAFONI_LANES_INLINE Lanes fbm_here(Vec3N<Lanes> q, NoiseCell cell, int octaves, std::uint32_t seed,
                                   [[maybe_unused]] Vec3N<Lanes>* grad) {
  Lanes sum(0.f);
  Vec3N<Lanes> g{Lanes(0.f), Lanes(0.f), Lanes(0.f)};
  float amplitude = 1, total = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    Vec3N<Lanes> octave_grad{Lanes(0.f), Lanes(0.f), Lanes(0.f)};
    const Lanes n =
        simplex_lanes(q.x, q.y, q.z, cell, seed + 0x9e3779b9u * static_cast<std::uint32_t>(octave),
                      with_gradient ? &octave_grad : nullptr);
    sum = mul_add(n, Lanes(amplitude), sum);
    // d/dq of 2^-k n(2^k q) is the octave's own gradient: the two powers cancel.
    if constexpr (with_gradient) g = g + octave_grad;
    total += amplitude;
    amplitude *= 0.5f;
    q = q * Lanes(2.f);
    cell = {cell.x + cell.x, cell.y + cell.y, cell.z + cell.z};
  }
  const Lanes norm(1.f / total);
  if constexpr (with_gradient) *grad = *grad + g * norm;
  return sum * norm;
}

/// Two copies an instruction set: copies in every kernel would be most of what there is to compile, and one
/// for both that asks at each corner whether a gradient is wanted is a tenth slower.
template <bool with_gradient>
HWY_NOINLINE Lanes fbm_there(Vec3N<Lanes> q, const NoiseCell& cell, int octaves, std::uint32_t seed,
                             Vec3N<Lanes>* grad) {
  return fbm_here<with_gradient>(q, cell, octaves, seed, grad);
}

}  // namespace noise_detail

/// Normalised fBm in [-1, 1]: sum of 2^-k simplex(2^k q) over the sum of 2^-k. `grad` as above.
TAFONI_LANES_INLINE Lanes fbm_lanes(Vec3N<Lanes> q, const NoiseCell& cell, int octaves, std::uint32_t seed,
                                    Vec3N<Lanes>* grad) {
  return grad ? noise_detail::fbm_there<true>(q, cell, octaves, seed, grad)
              : noise_detail::fbm_there<false>(q, cell, octaves, seed, nullptr);
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni
HWY_AFTER_NAMESPACE();

#endif
