#pragma once
// Half precision numbers (IEEE 754 binary16), for storage.

#include <bit>
#include <cstddef>
#include <cstdint>

namespace tafoni {

/// To the nearest half, ties to even. What is too large for one becomes the largest, 65504; NaN stays NaN.
inline std::uint16_t to_half(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = (bits >> 16) & 0x8000, magnitude = bits & 0x7fffffff;
  std::uint32_t half;
  if (magnitude > 0x7f800000) {
    half = 0x7e00;
  } else if (magnitude < 0x38800000) {
    // Below 2^-14 halves are multiples of 2^-24, which is how finely floats from 0.5 to 1 are spaced.
    half = std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude) + 0.5f) - 0x3f000000;
  } else {
    half = (magnitude - 0x38000000 + 0xfff + ((magnitude >> 13) & 1)) >> 13;
    if (magnitude >= 0x477ff000) half = 0x7bff;
  }
  return static_cast<std::uint16_t>(sign | half);
}

inline float from_half(std::uint16_t half) {
  const std::uint32_t sign = (half & 0x8000u) << 16, magnitude = half & 0x7fffu;
  if (magnitude < 0x400)  // a multiple of 2^-24
    return std::bit_cast<float>(sign |
                                std::bit_cast<std::uint32_t>(static_cast<float>(magnitude) * 0x1p-24f));
  const std::uint32_t bias = magnitude < 0x7c00 ? 112u << 23 : 224u << 23;
  return std::bit_cast<float>(sign | ((magnitude << 13) + bias));
}

/// Many at once, the same bits.
void to_half(const float* from, std::size_t n, std::uint16_t* out);
void from_half(const std::uint16_t* from, std::size_t n, float* out);

}  // namespace tafoni
