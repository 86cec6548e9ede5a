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

/// One corner's t^4 (g . d) with t = 1/2 - |d|^2 (so that the kernel is C^2 and vanishes before the next
/// simplex), and its gradient when `grad` is given. g is one of the twelve edge directions of a cube.
TAFONI_LANES_INLINE Lanes corner(Lanes dx, Lanes dy, Lanes dz, Ints i, Ints j, Ints k, Ints seed,
                                 Vec3N<Lanes>* grad) {
  Ints h = (i * Ints(0x27d4eb2d)) ^ (j * Ints(0x165667b1)) ^ (k * Ints(0x1b873593)) ^ seed;
  h = h * Ints(0x2c1b3c6d);
  h = h ^ shift_right_unsigned<15>(h);
  h = h * Ints(0x297a2d39);
  // Axis left out: bits 16.. scaled to 0, 1, 2. The two signs: the top bits.
  const Ints axis = shift_right_unsigned<16>(shift_right_unsigned<16>(h & Ints(0x00ffff00)) * Ints(3 * 256));
  const Lanes sign_a =
      hn::BitCast(float_tag, ((h & Ints(static_cast<std::int32_t>(0x80000000u))) ^ Ints(0x3f800000)).v);
  const Lanes sign_b = hn::BitCast(
      float_tag, ((shift_left<1>(h) & Ints(static_cast<std::int32_t>(0x80000000u))) ^ Ints(0x3f800000)).v);
  const Mask no_x = hn::RebindMask(float_tag, hn::Eq(axis.v, Ints(0).v));
  const Mask no_y = hn::RebindMask(float_tag, hn::Eq(axis.v, Ints(1).v));
  const Lanes gx = select(no_x, Lanes(0.f), sign_a);
  const Lanes gy = select(no_y, Lanes(0.f), select(no_x, sign_a, sign_b));
  const Lanes gz = select(no_x, sign_b, select(no_y, sign_b, Lanes(0.f)));
  const Lanes t = max(neg_mul_add(dz, dz, neg_mul_add(dy, dy, neg_mul_add(dx, dx, Lanes(0.5f)))), Lanes(0.f));
  const Lanes t2 = t * t, t4 = t2 * t2;
  const Lanes gd = mul_add(gz, dz, mul_add(gy, dy, gx * dx));
  if (grad) {
    const Lanes k8 = Lanes(-8.f) * t2 * t * gd;
    grad->x = grad->x + mul_add(k8, dx, t4 * gx);
    grad->y = grad->y + mul_add(k8, dy, t4 * gy);
    grad->z = grad->z + mul_add(k8, dz, t4 * gz);
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
  // Rank of each coordinate decides the walk through the simplex.
  const Mask xy = x0 >= y0, yz = y0 >= z0, xz = x0 >= z0;
  const Lanes zero(0.f), one(1.f);
  const Lanes i1 = select(hn::And(xy, xz), one, zero);
  const Lanes j1 = select(hn::AndNot(xy, yz), one, zero);
  const Lanes k1 = one - i1 - j1;
  const Lanes i2 = select(hn::Or(xy, xz), one, zero);
  const Lanes k2 = select(hn::And(xz, yz), zero, one);
  const Lanes j2 = Lanes(2.f) - i2 - k2;
  const Ints s(static_cast<std::int32_t>(seed));
  using noise_detail::corner;
  Vec3N<Lanes> g{zero, zero, zero};
  Vec3N<Lanes>* gp = grad ? &g : nullptr;
  constexpr float c = 1.f / 6;
  Lanes n = corner(x0, y0, z0, i, j, k, s, gp);
  n = n + corner(x0 - i1 + Lanes(c), y0 - j1 + Lanes(c), z0 - k1 + Lanes(c), i + truncated(i1),
                 j + truncated(j1), k + truncated(k1), s, gp);
  n = n + corner(x0 - i2 + Lanes(2 * c), y0 - j2 + Lanes(2 * c), z0 - k2 + Lanes(2 * c), i + truncated(i2),
                 j + truncated(j2), k + truncated(k2), s, gp);
  n = n + corner(x0 - Lanes(0.5f), y0 - Lanes(0.5f), z0 - Lanes(0.5f), i + Ints(1), j + Ints(1), k + Ints(1),
                 s, gp);
  if (grad) {
    grad->x = mul_add(g.x, Lanes(simplex_scale), grad->x);
    grad->y = mul_add(g.y, Lanes(simplex_scale), grad->y);
    grad->z = mul_add(g.z, Lanes(simplex_scale), grad->z);
  }
  return n * Lanes(simplex_scale);
}

/// Normalised fBm in [-1, 1]: sum of 2^-k simplex(2^k q) over the sum of 2^-k. `grad` as above.
/// One copy an instruction set: beside its octaves a call costs nothing, and copies in every kernel would be
/// most of what there is to compile.
HWY_NOINLINE inline Lanes fbm_lanes(Vec3N<Lanes> q, NoiseCell cell, int octaves, std::uint32_t seed,
                                    Vec3N<Lanes>* grad) {
  Lanes sum(0.f);
  Vec3N<Lanes> g{Lanes(0.f), Lanes(0.f), Lanes(0.f)};
  float amplitude = 1, total = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    Vec3N<Lanes> octave_grad{Lanes(0.f), Lanes(0.f), Lanes(0.f)};
    const Lanes n =
        simplex_lanes(q.x, q.y, q.z, cell, seed + 0x9e3779b9u * static_cast<std::uint32_t>(octave),
                      grad ? &octave_grad : nullptr);
    sum = mul_add(n, Lanes(amplitude), sum);
    // d/dq of 2^-k n(2^k q) is the octave's own gradient: the two powers cancel.
    if (grad) g = g + octave_grad;
    total += amplitude;
    amplitude *= 0.5f;
    q = q * Lanes(2.f);
    cell = {cell.x + cell.x, cell.y + cell.y, cell.z + cell.z};
  }
  const Lanes norm(1.f / total);
  if (grad) *grad = *grad + g * norm;
  return sum * norm;
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni
HWY_AFTER_NAMESPACE();

#endif
