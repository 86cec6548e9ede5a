#include "tafoni/core/random.h"

#include <array>
#include <bit>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace tafoni {
namespace {

TEST(Random, MixIsTheReferenceSequence) {
  // SplitMix64 from state 0: the published first outputs.
  EXPECT_EQ(mix64(0), 0xe220a8397b1dcdafull);
  EXPECT_EQ(mix64(0x9e3779b97f4a7c15ull), 0x6e789e6aa1b965f4ull);
}

TEST(Random, ValueDependsOnIndexAlone) {
  Random a(7, 3), b(7, 3);
  const std::uint64_t third = b.at(2);
  a.next();
  a.next();
  EXPECT_EQ(a.next(), third);
  EXPECT_EQ(b.next(), Random(7, 3).at(0));
}

TEST(Random, SeedsAndStreamsDiffer) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (std::uint64_t stream = 0; stream < 50; ++stream) seen.insert(Random(seed, stream).at(0));
  EXPECT_EQ(seen.size(), 2500u);
}

TEST(Random, UniformFillsTheUnitIntervalEvenly) {
  Random random(1);
  std::array<int, 16> bins{};
  constexpr int n = 160000;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    ++bins[static_cast<std::size_t>(u * 16)];
  }
  double chi2 = 0;
  for (int count : bins) chi2 += (count - n / 16.0) * (count - n / 16.0) / (n / 16.0);
  EXPECT_LT(chi2, 40);  // 15 degrees of freedom: beyond this once in 2000
}

TEST(Random, BelowStaysBelow) {
  Random random(2);
  std::array<int, 7> bins{};
  for (int i = 0; i < 70000; ++i) {
    const auto v = random.below(7);
    ASSERT_LT(v, 7u);
    ++bins[v];
  }
  for (int count : bins) EXPECT_NEAR(count, 10000, 500);
  EXPECT_EQ(random.below(1), 0u);
}

TEST(Random, OneBitOfTheSeedChangesHalfTheBits) {
  double changed = 0;
  for (int bit = 0; bit < 64; ++bit)
    changed += std::popcount(Random(5).at(0) ^ Random(5 ^ (std::uint64_t{1} << bit)).at(0));
  EXPECT_NEAR(changed / 64, 32, 4);
}

}  // namespace
}  // namespace tafoni
