#pragma once
// Canonical order of things in space: along a space-filling curve, ties by their numbers.

#include <bit>
#include <compare>
#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

/// Cells of 2^21 units (256 m), and positions within them.
inline constexpr int cell_bits = 21;
inline constexpr std::int32_t cell_mask = (1 << cell_bits) - 1;

/// Spreads the low 21 bits of v to every third bit.
constexpr std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

/// Where a position, in units, lies on the curve.
struct CurveKey {
  std::uint64_t cell, within;
  friend constexpr auto operator<=>(const CurveKey&, const CurveKey&) = default;
};
constexpr CurveKey curve_key(Vec3i at) {
  constexpr std::int32_t bias = 1 << (31 - cell_bits);
  const auto cell = [](std::int32_t v) { return spread((v >> cell_bits) + bias); };
  const auto within = [](std::int32_t v) { return spread(v & cell_mask); };
  return {cell(at.x) | cell(at.y) << 1 | cell(at.z) << 2,
          within(at.x) | within(at.y) << 1 | within(at.z) << 2};
}

/// Total order on floats that a sort may use: by bits, negative numbers reversed.
inline std::uint32_t order_key(float v) {
  const auto bits = std::bit_cast<std::uint32_t>(v);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

}  // namespace tafoni::field::impl
