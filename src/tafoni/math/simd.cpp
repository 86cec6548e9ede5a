#include "tafoni/math/simd.h"

#include <cstdlib>
#include <mutex>
#include <string_view>

#include <hwy/highway.h>

namespace tafoni {
namespace {

// Highway's targets are bits, better ones lower.
constexpr std::int64_t better_than(std::int64_t target) {
  return target - 1;
}

}  // namespace

void limit_simd() {
  static std::once_flag once;
  std::call_once(once, [] {
    const char* text = std::getenv("TAFONI_SIMD");
    const std::string_view wanted = text ? text : "";
    if (wanted == "avx2") hwy::DisableTargets(better_than(HWY_AVX2));
    if (wanted == "sse4") hwy::DisableTargets(better_than(HWY_SSE4));
    if (wanted == "scalar") hwy::DisableTargets(better_than(HWY_SCALAR));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  });
}

std::string simd_name() {
  limit_simd();
  const std::int64_t targets = hwy::SupportedTargets();
  if (targets & HWY_AVX3) return "avx512";
  if (targets & HWY_AVX2) return "avx2";
  if (targets & HWY_SSE4) return "sse4";
  return "scalar";
}

}  // namespace tafoni
