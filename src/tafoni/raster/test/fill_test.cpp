#include "tafoni/raster/fill.h"

#include <cmath>

#include <gmock/gmock.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/raster/sampled.h"

namespace tafoni::raster {
namespace {

template <class F>
Raster make(int width, int height, double dx, double dy, F&& f) {
  return sampled(width, height, {0, height * dy, dx, dy}, f);
}
void punch(Raster& raster, double col, double row, double radius) {
  for (int r = 0; r < raster.height(); ++r)
    for (int c = 0; c < raster.width(); ++c)
      if (std::hypot(c - col, r - row) <= radius) raster.values.at(c, r) = no_data;
}
double worst(const Raster& got, const Raster& want) {
  double out = 0;
  for (std::size_t i = 0; i < got.values.size(); ++i) {
    const float d = std::abs(got.values.values()[i] - want.values.values()[i]);
    out = std::isnan(d) ? 1e30 : std::max<double>(out, d);
  }
  return out;
}
double plane(double x, double y) {
  return 200 + 0.3 * x - 0.7 * y;
}
/// A valley and its two slopes: what a membrane would leave a dent or a bump in.
double valley(double x, double y) {
  return 300 + 40 * std::cos(x / 9) + 0.2 * y;
}

TEST(FillHoles, ContinuesAPlaneExactly) {
  for (const double dy : {1.0, 2.5}) {
    const Raster want = make(64, 64, 1, dy, plane);
    Raster got = want;
    punch(got, 30, 20, 5);
    punch(got, 50, 50, 0);
    const FillReport report = fill_holes(got, 20);
    EXPECT_GT(report.filled, 70u);
    EXPECT_EQ(report.left, 0u);
    EXPECT_LT(worst(got, want), 5e-3);
  }
}

TEST(FillHoles, FollowsCurvatureBetterThanAMembrane) {
  const Raster want = make(64, 64, 1, 1, valley);
  Raster plate = want;
  punch(plate, 28.27, 30, 4);
  Raster membrane = plate;
  fill_holes(plate, 10);
  fill_all(membrane);
  EXPECT_LT(worst(plate, want), 0.8);
  EXPECT_GT(worst(membrane, want), 2 * worst(plate, want));
}

TEST(FillHoles, LeavesLargeHolesWhole) {
  Raster got = make(80, 80, 2, 2, plane);
  punch(got, 20, 20, 3);   // 3 pixels: 6 m
  punch(got, 55, 55, 12);  // 24 m
  std::size_t large = 0;
  for (int r = 0; r < 80; ++r)
    for (int c = 0; c < 80; ++c) large += c > 40 && std::isnan(got.values.at(c, r));
  const FillReport report = fill_holes(got, 10);
  EXPECT_EQ(report.left, large);
  EXPECT_FALSE(std::isnan(got.values.at(20, 20)));
  // Not even the rim of the large hole grows.
  EXPECT_TRUE(std::isnan(got.values.at(55, 55 - 12)));
}

TEST(FillHoles, ZeroDistanceAndNoDataChangeNothing) {
  Raster got = make(20, 20, 1, 1, plane);
  punch(got, 10, 10, 2);
  EXPECT_EQ(fill_holes(got, 0).filled, 0u);
  Raster none = make(20, 20, 1, 1, [](double, double) { return NAN; });
  EXPECT_EQ(fill_holes(none, 100).left, 400u);
}

TEST(FillHoles, StaysWithinTheDataAtTheRim) {
  Raster got = make(200, 120, 30, 30, valley);
  for (int r = 0; r < 120; ++r)
    for (int c = 0; c < 200; ++c)
      if (c < 1 + r / 20 || c > 193 - r / 30 || r < c / 60) got.values.at(c, r) = no_data;
  EXPECT_EQ(fill_holes(got, 300).left, 0u);
  for (const float v : got.values.values()) {
    ASSERT_GE(v, 259);
    ASSERT_LE(v, 1061);
  }
}

TEST(FillAll, StaysWithinTheDataAndHasNoSteps) {
  Raster got = make(300, 200, 1, 1, valley);
  const Raster want = got;
  for (int r = 0; r < 200; ++r)
    for (int c = 0; c < 300; ++c)
      if (c > 150 + 20 * std::sin(r / 15.0)) got.values.at(c, r) = no_data;
  fill_all(got);
  for (int r = 0; r < 200; ++r)
    for (int c = 0; c < 300; ++c) {
      const float v = got.values.at(c, r);
      ASSERT_GE(v, 259.9f);
      ASSERT_LE(v, 380.1f);
      // The steepest slope of the data is 40 / 9.
      if (c > 0) {
        ASSERT_LT(std::abs(v - got.values.at(c - 1, r)), 4.6f) << c << ' ' << r;
      }
      if (c < 120) {
        ASSERT_EQ(v, want.values.at(c, r));
      }
    }
}

TEST(FillAll, OnePixelIsEnough) {
  Raster got = make(37, 5, 1, 1, [](double, double) { return NAN; });
  EXPECT_EQ(error_of([&] { fill_all(got); }), "the elevations hold no data at all.");
  got.values.at(36, 0) = 7;
  fill_all(got);
  for (const float v : got.values.values()) EXPECT_NEAR(v, 7, 1e-5);
}

}  // namespace
}  // namespace tafoni::raster
