#pragma once
// Which instruction set the SIMD kernels use.

#include <string>

namespace tafoni {

/// Applies the environment variable TAFONI_SIMD once, before any kernel is chosen: "avx512", "avx2", "sse4"
/// or "scalar" limits the kernels to that instruction set. AVX2 and AVX-512 give the same bits; the others
/// lack fused multiply-add and differ in the last digits. Anything else, or nothing, means the best this
/// machine has.
void limit_simd();

/// "avx512", "avx2", "sse4" or "scalar": what the kernels use here.
std::string simd_name();

}  // namespace tafoni
