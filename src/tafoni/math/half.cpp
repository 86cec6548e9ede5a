// Floats to 16 bits and back over SIMD lanes, in scalar code where the instruction set has no conversion.

#include "tafoni/math/half.h"

#include <hwy/highway.h>

#include "tafoni/math/simd.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Instruction sets without conversions of their own are left to the scalar code: Highway's do not round
// there.
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
constexpr bool converts = true;
#else
constexpr bool converts = false;
#endif

void to_half_kernel(const float* from, std::size_t n, std::uint16_t* out) {
  std::size_t i = 0;
  if constexpr (converts) {
    const hn::CappedTag<float, 8> d;
    const hn::Rebind<hwy::float16_t, decltype(d)> half;
    const auto most = hn::Set(d, 65504.0f), least = hn::Set(d, -65504.0f);
    for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
      const auto v = hn::LoadU(d, from + i);
      const auto limited = hn::IfThenElse(hn::Eq(v, v), hn::Min(hn::Max(v, least), most), v);
      hn::StoreU(hn::DemoteTo(half, limited), half, reinterpret_cast<hwy::float16_t*>(out + i));
    }
  }
  for (; i < n; ++i) out[i] = to_half(from[i]);
}

void from_half_kernel(const std::uint16_t* from, std::size_t n, float* out) {
  std::size_t i = 0;
  if constexpr (converts) {
    const hn::CappedTag<float, 8> d;
    const hn::Rebind<hwy::float16_t, decltype(d)> half;
    for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d))
      hn::StoreU(hn::PromoteTo(d, hn::LoadU(half, reinterpret_cast<const hwy::float16_t*>(from + i))), d,
                 out + i);
  }
  for (; i < n; ++i) out[i] = from_half(from[i]);
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni {

HWY_EXPORT(to_half_kernel);
HWY_EXPORT(from_half_kernel);

void to_half(const float* from, std::size_t n, std::uint16_t* out) {
  limit_simd();
  HWY_DYNAMIC_DISPATCH(to_half_kernel)(from, n, out);
}

void from_half(const std::uint16_t* from, std::size_t n, float* out) {
  limit_simd();
  HWY_DYNAMIC_DISPATCH(from_half_kernel)(from, n, out);
}

}  // namespace tafoni
#endif
