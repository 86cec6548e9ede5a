#include "tafoni/raster/resample.h"

#include <cmath>

#include <gmock/gmock.h>

#include "tafoni/math/counts.h"
#include "tafoni/raster/sampled.h"

namespace tafoni::raster {
namespace {

template <class F>
Raster make(int width, int height, Placement placement, F&& f) {
  Raster out = sampled(width, height, placement, f);
  out.crs = "crs";
  return out;
}
double tilted(double x, double y) {
  return 5 + 0.25 * x - 0.5 * y;
}

TEST(Sample, ReproducesAPlaneBetweenCentresAndPixelsAtThem) {
  const Raster r = make(12, 9, {100, 200, 2, 3}, tilted);
  for (double x = 104; x < 120; x += 0.37)
    for (double y = 178; y < 194; y += 0.41) {
      EXPECT_NEAR(sample_bilinear(r, x, y), tilted(x, y), 1e-4);
      EXPECT_NEAR(sample_bicubic(r, x, y), tilted(x, y), 1e-4);
    }
  const Vec2d p = r.placement.center(3, 4);
  EXPECT_EQ(sample_bicubic(r, p.x, p.y), r.at(3, 4));
}

TEST(Sample, ContinuesTheNearestValueBeyondTheRim) {
  const Raster r = make(4, 4, {0, 4, 1, 1}, tilted);
  EXPECT_FLOAT_EQ(static_cast<float>(sample_bilinear(r, -50, 3.5)), r.values.at(0, 0));
  EXPECT_FLOAT_EQ(static_cast<float>(sample_bicubic(r, 99, -99)), r.values.at(3, 3));
  const Raster one = make(1, 1, {0, 1, 1, 1}, tilted);
  EXPECT_FLOAT_EQ(static_cast<float>(sample_bilinear(one, 0.9, 0.1)), one.values.at(0, 0));
}

TEST(Sample, LeavesMissingPixelsOut) {
  Raster r = make(6, 6, {0, 6, 1, 1}, [](double, double) { return 3.0; });
  r.values.at(2, 2) = no_data;
  EXPECT_TRUE(std::isnan(sample_bilinear(r, 2.6, 3.6)));
  EXPECT_DOUBLE_EQ(sample_bilinear(r, 3.2, 3.5), 3.0);
  EXPECT_DOUBLE_EQ(sample_bicubic(r, 3.2, 3.5), 3.0);
}

TEST(Resample, AverageKeepsTheMeanForAnyRatio) {
  const Raster source = make(60, 42, {10, 500, 1, 1}, [](double x, double y) {
    return std::sin(x * 1.7) * 10 + std::cos(y * 2.3) * 7;
  });
  const double want = mean(source.values.values());
  for (const auto& [w, h] : {std::pair{10, 7}, std::pair{7, 5}, std::pair{60, 42}, std::pair{1, 1}}) {
    const Raster got = resample(source, {10, 500, 60.0 / w, 42.0 / h}, w, h, Resampling::average);
    EXPECT_NEAR(mean(got.values.values()), want, 1e-4) << w;
    EXPECT_EQ(got.crs, "crs");
  }
}

TEST(Resample, AverageNeedsHalfThePixelCovered) {
  Raster source = make(4, 2, {0, 2, 1, 1}, [](double x, double) { return x; });
  source.values.at(0, 0) = source.values.at(1, 0) = no_data;
  source.values.at(2, 0) = source.values.at(3, 0) = source.values.at(2, 1) = no_data;
  const Raster got = resample(source, {0, 2, 2, 2}, 2, 1, Resampling::average);
  EXPECT_FLOAT_EQ(got.values.at(0, 0), 1.0f);  // mean of 0.5 and 1.5
  EXPECT_TRUE(std::isnan(got.values.at(1, 0)));
}

TEST(AtResolution, CoversTheSameGroundWithSquarePixels) {
  const Raster source = make(100, 40, {0, 1000, 10, 25}, tilted);
  const Raster coarse = at_resolution(source, 50);
  EXPECT_EQ(coarse.width(), 20);
  EXPECT_EQ(coarse.height(), 20);
  const Raster fine = at_resolution(source, 5);
  EXPECT_EQ(fine.width(), 200);
  EXPECT_EQ(fine.height(), 200);
  for (const Raster* r : {&coarse, &fine}) {
    const Vec2d p = r->placement.center(9, 9);
    EXPECT_NEAR(r->values.at(9, 9), tilted(p.x, p.y), 1e-3);
  }
}

}  // namespace
}  // namespace tafoni::raster
