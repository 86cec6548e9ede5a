// Noise at points: the kernels of noise-inl.h, eight points or fewer at a time, for the instruction set at
// hand.

#include "tafoni/math/noise.h"

#include "tafoni/core/random.h"
#include "tafoni/math/noise-inl.h"
#include "tafoni/math/simd.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni {
namespace HWY_NAMESPACE {

void fbm_points(const Vec3d* points, std::size_t n, int octaves, std::uint32_t seed, float* out) {
  constexpr std::size_t most = 8;
  const std::size_t width = lane_count();
  for (std::size_t begin = 0; begin < n; begin += width) {
    alignas(32) float q[3][most] = {}, result[most];
    alignas(32) std::int32_t m[3][most] = {};
    const std::size_t count = std::min(width, n - begin);
    for (std::size_t l = 0; l < count; ++l) {
      const Vec3d& p = points[begin + l];
      const double xyz[3] = {p.x, p.y, p.z};
      for (int c = 0; c < 3; ++c) {
        const double cell = std::floor(xyz[c] / 3);
        m[c][l] = static_cast<std::int32_t>(cell);
        q[c][l] = static_cast<float>(xyz[c] - 3 * cell);
      }
    }
    const NoiseCell cell = noise_cell(Ints::load(m[0]), Ints::load(m[1]), Ints::load(m[2]));
    // Here rather than there: the constants stay in registers from one group of points to the next.
    const Lanes t = noise_detail::fbm_here<false>({Lanes::load(q[0]), Lanes::load(q[1]), Lanes::load(q[2])},
                                                  cell, octaves, seed, nullptr);
    min(max(mul_add(t, Lanes(0.5f), Lanes(0.5f)), Lanes(0.f)), Lanes(1.f)).store(result);
    std::copy_n(result, count, out + begin);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni {

HWY_EXPORT(fbm_points);

void fbm(std::span<const Vec3d> points, int octaves, std::uint64_t seed, std::span<float> out) {
  limit_simd();
  HWY_DYNAMIC_DISPATCH(fbm_points)
  (points.data(), points.size(), octaves, static_cast<std::uint32_t>(mix64(seed)), out.data());
}

float fbm(Vec3d p, int octaves, std::uint64_t seed) {
  float out = 0;
  fbm({&p, 1}, octaves, seed, {&out, 1});
  return out;
}

float simplex(Vec3d p, std::uint64_t seed) {
  return fbm(p, 1, seed);
}

}  // namespace tafoni
#endif
