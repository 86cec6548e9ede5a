#include "tafoni/math/half.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"

namespace tafoni {
namespace {

/// The value by the definition of the format.
double meaning(std::uint16_t half) {
  const int exponent = (half >> 10) & 31, fraction = half & 1023;
  const double magnitude =
      exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return half & 0x8000 ? -magnitude : magnitude;
}

TEST(Half, EveryHalfMeansWhatTheFormatSaysAndComesBack) {
  for (std::uint32_t h = 0; h < 0x10000; ++h) {
    const auto half = static_cast<std::uint16_t>(h);
    if ((half & 0x7c00) == 0x7c00) continue;
    EXPECT_EQ(from_half(half), meaning(half));
    EXPECT_EQ(std::signbit(from_half(half)), (half & 0x8000) != 0);
    EXPECT_EQ(to_half(from_half(half)), half);
  }
  EXPECT_TRUE(std::isinf(from_half(0x7c00)));
  EXPECT_TRUE(std::isnan(from_half(0x7e00)));
}

TEST(Half, RoundsToTheNearestTiesToEven) {
  for (std::uint32_t h = 0; h < 0x7bff; ++h) {
    const auto low = static_cast<std::uint16_t>(h), high = static_cast<std::uint16_t>(h + 1);
    const float middle = static_cast<float>((meaning(low) + meaning(high)) / 2);
    EXPECT_EQ(to_half(middle), h & 1 ? high : low) << h;
    EXPECT_EQ(to_half(std::nextafter(middle, 0.f)), low) << h;
    EXPECT_EQ(to_half(std::nextafter(middle, 1e6f)), high) << h;
    EXPECT_EQ(to_half(-middle), 0x8000 | (h & 1 ? high : low)) << h;
  }
}

TEST(Half, WhatIsTooLargeBecomesTheLargest) {
  for (float large : {65504.f, 65519.f, 65520.f, 1e10f, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(to_half(large), 0x7bff);
    EXPECT_EQ(to_half(-large), 0xfbff);
  }
  EXPECT_TRUE(std::isnan(from_half(to_half(std::numeric_limits<float>::quiet_NaN()))));
}

TEST(Half, ManyAtOnceGiveTheSameBits) {
  std::vector<std::uint16_t> halves;
  for (std::uint32_t h = 0; h < 0x10000; ++h)
    if ((h & 0x7c00) != 0x7c00) halves.push_back(static_cast<std::uint16_t>(h));
  std::vector<float> floats(halves.size());
  from_half(halves.data(), halves.size(), floats.data());
  for (std::size_t i = 0; i < halves.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(floats[i]), std::bit_cast<std::uint32_t>(from_half(halves[i])));

  Random random(1);
  std::vector<float> any{0.f, -0.f, 65504.f, 65519.f, 65520.f, -1e30f, 1e-30f, -1e-7f, 6e-8f, 3e-8f};
  for (int i = 0; i < 200003; ++i) {
    const float v = std::bit_cast<float>(static_cast<std::uint32_t>(random.next()));
    if (std::isfinite(v)) any.push_back(i % 2 ? v : std::fmod(v, 300.f));
  }
  for (std::uint32_t h = 1; h < 0x7bff; ++h)  // ties
    any.push_back((from_half(static_cast<std::uint16_t>(h)) + from_half(static_cast<std::uint16_t>(h + 1))) /
                  2);
  std::vector<std::uint16_t> out(any.size());
  to_half(any.data(), any.size(), out.data());
  for (std::size_t i = 0; i < any.size(); ++i) ASSERT_EQ(out[i], to_half(any[i])) << any[i];
}

}  // namespace
}  // namespace tafoni
