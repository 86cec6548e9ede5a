#include "tafoni/raster/steps.h"

#include <cmath>

#include <gmock/gmock.h>

namespace tafoni::raster {
namespace {

double hills(double x, double y) {
  return 100 + 8 * std::sin(x / 31) * std::cos(y / 23) + 0.02 * x + 3 * std::sin((x + y) / 47);
}
template <class F>
Raster make(int size, F&& f) {
  Raster out{Grid<float>(size, size), {0, 1.0 * size, 1, 1}, ""};
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < size; ++c) out.values.at(c, r) = static_cast<float>(f(c, r));
  return out;
}
double rms(const Raster& a, const Raster& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    sum += std::pow(a.values.values()[i] - b.values.values()[i], 2);
  return std::sqrt(sum / static_cast<double>(a.values.size()));
}
/// Root mean square of second differences: what the eye sees as terraces.
double roughness(const Raster& a) {
  double sum = 0;
  for (int r = 0; r < a.height(); ++r)
    for (int c = 1; c + 1 < a.width(); ++c)
      sum += std::pow(a.values.at(c - 1, r) - 2 * a.values.at(c, r) + a.values.at(c + 1, r), 2);
  return std::sqrt(sum / static_cast<double>(a.values.size()));
}

TEST(DetectStep, FindsTheStepOfQuantizedData) {
  for (const double step : {1.0, 0.5, 2.0 / 3}) {
    const Raster stepped =
        make(256, [&](double x, double y) { return step * std::round(hills(x, y) / step); });
    EXPECT_NEAR(detect_step(stepped.values), step, 1e-4);
  }
}

TEST(DetectStep, IsZeroWhereNoTerracesShow) {
  EXPECT_EQ(detect_step(make(256, hills).values), 0);
  // Whole metres on steep ground: neighbours differ by several.
  EXPECT_EQ(detect_step(make(256, [](double x, double y) { return std::round(40 * hills(x, y)); }).values),
            0);
  EXPECT_EQ(detect_step(make(256, [](double, double) { return 5.0; }).values), 0);
  // Free heights beside a flat lake.
  EXPECT_EQ(detect_step(make(256, [](double x, double y) { return std::max(hills(x, y), 104.0); }).values),
            0);
  EXPECT_EQ(detect_step(Grid<float>(1, 1, no_data)), 0);
}

TEST(RemoveSteps, BringsBackTheSurfaceWithinHalfAStep) {
  const Raster truth = make(256, hills);
  const Raster stepped = make(256, [](double x, double y) { return std::round(hills(x, y)); });
  Raster got = stepped;
  remove_steps(got, 1);
  for (std::size_t i = 0; i < got.values.size(); ++i)
    ASSERT_LE(std::abs(got.values.values()[i] - stepped.values.values()[i]), 0.5f + 1e-4f);
  EXPECT_LT(rms(got, truth), 0.33 * rms(stepped, truth));
  EXPECT_LT(roughness(got), 0.1 * roughness(stepped));
  EXPECT_LT(roughness(got), 3 * roughness(truth));
}

TEST(RemoveSteps, KeepsCliffsAndHoles) {
  Raster got = make(128, [](double x, double y) { return std::round(x < 64 ? 20 + y / 40 : 80 + y / 25); });
  got.values.at(10, 10) = no_data;
  remove_steps(got, 1);
  EXPECT_TRUE(std::isnan(got.values.at(10, 10)));
  for (int r = 0; r < 128; ++r) EXPECT_GE(got.values.at(64, r) - got.values.at(63, r), 58);
}

}  // namespace
}  // namespace tafoni::raster
