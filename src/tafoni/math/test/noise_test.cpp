#include "tafoni/math/noise.h"

#include <vector>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"

namespace tafoni {
namespace {

std::vector<Vec3d> random_points(std::size_t n, double extent, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> points(n);
  for (auto& p : points)
    p = {random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-extent, extent)};
  return points;
}

TEST(Noise, StaysInTheUnitRangeAndUsesMostOfIt) {
  const auto points = random_points(400000, 1000, 1);
  std::vector<float> t(points.size());
  fbm(points, 1, 5, t);
  const auto [lo, hi] = std::minmax_element(t.begin(), t.end());
  EXPECT_GE(*lo, 0.f);
  EXPECT_LE(*hi, 1.f);
  EXPECT_LT(*lo, 0.08f);
  EXPECT_GT(*hi, 0.92f);
  double sum = 0;
  for (float v : t) sum += v;
  EXPECT_NEAR(sum / static_cast<double>(t.size()), 0.5, 0.005);
}

TEST(Noise, BatchEqualsSinglePointBitForBit) {
  const auto points = random_points(1003, 1e6, 2);
  std::vector<float> t(points.size());
  fbm(points, 4, 9, t);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(t[i], fbm(points[i], 4, 9));
}

TEST(Noise, IsContinuousAcrossSimplexAndTranslationBorders) {
  // A step of 1e-4 may change the value by at most the step times the greatest slope (under 8).
  for (double base : {0.0, 2.9999, 3e6, -3e6})
    for (int axis = 0; axis < 3; ++axis) {
      float last = 0;
      for (int i = 0; i < 40000; ++i) {
        Vec3d p{0.37, 0.21, 0.83};
        (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += base + i * 1e-4;
        const float v = simplex(p, 3);
        if (i > 0) {
          ASSERT_NEAR(v, last, 8e-4) << base << " " << i;
        }
        last = v;
      }
    }
}

TEST(Noise, DependsOnSeedAndOctaves) {
  const Vec3d p{1.3, 2.4, -0.2};
  EXPECT_NE(simplex(p, 1), simplex(p, 2));
  EXPECT_NE(fbm(p, 1, 1), fbm(p, 3, 1));
}

}  // namespace
}  // namespace tafoni
