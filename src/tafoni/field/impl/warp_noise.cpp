#include "tafoni/field/impl/warp_noise.h"

#include "tafoni/math/noise-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

/// As LocalNoise does it: far positions split into cells to hash and a small remainder in float.
template <bool with_jacobian>
void displace(const WarpNoise& noise, const Vec3d* points, std::size_t n, Displacement& out) {
  alignas(32) float q[3][8] = {};
  alignas(32) std::int32_t m[3][8] = {};
  for (std::size_t l = 0; l < n; ++l) {
    const double at[3] = {points[l].x * noise.inv_lateral, points[l].y * noise.inv_lateral,
                          points[l].z * noise.inv_vertical};
    for (int c = 0; c < 3; ++c) {
      const double cell = std::floor(at[c] / 3);
      m[c][l] = static_cast<std::int32_t>(cell);
      q[c][l] = static_cast<float>(at[c] - 3 * cell);
    }
  }
  const Lanes scale[3] = {Lanes(static_cast<float>(noise.inv_lateral)),
                          Lanes(static_cast<float>(noise.inv_lateral)),
                          Lanes(static_cast<float>(noise.inv_vertical))};
  for (std::size_t l = 0; l < n; l += lane_count()) {
    const NoiseCell cell = noise_cell(Ints::load(m[0] + l), Ints::load(m[1] + l), Ints::load(m[2] + l));
    const Vec3N<Lanes> at{Lanes::load(q[0] + l), Lanes::load(q[1] + l), Lanes::load(q[2] + l)};
    for (int i = 0; i < 3; ++i) {
      const Lanes amplitude(noise.amplitude[i]);
      Vec3N<Lanes> g{Lanes(0.f), Lanes(0.f), Lanes(0.f)};
      const Lanes t = fbm_lanes(at, cell, noise.octaves, noise.seed[i], with_jacobian ? &g : nullptr);
      (t * amplitude).store(out.d[i] + l);
      if constexpr (with_jacobian) {
        (g.x * amplitude * scale[0]).store(out.jacobian[3 * i] + l);
        (g.y * amplitude * scale[1]).store(out.jacobian[3 * i + 1] + l);
        (g.z * amplitude * scale[2]).store(out.jacobian[3 * i + 2] + l);
      }
    }
  }
}

WarpKernels make_warp() {
  return {&displace<false>, &displace<true>};
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field::impl {

HWY_EXPORT(make_warp);

const WarpKernels& warp_kernels() {
  static const WarpKernels table = HWY_DYNAMIC_DISPATCH(make_warp)();
  return table;
}

}  // namespace tafoni::field::impl
#endif
