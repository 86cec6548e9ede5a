#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/geology/kind.h"
#include "tafoni/math/counts.h"
#include "tafoni/math/noise.h"

namespace tafoni::geology {
namespace {

constexpr Vec3d none{};

GeologyPtr pure_strata(Values values) {
  for (const char* name : {"variation", "hardness_variation", "waviness", "turbulence", "transition"})
    values.try_emplace(name, 0.0);
  return make_geology("strata", values, {}, none, 4);
}

TEST(Strata, WithoutVariationBedsAreWhatIsGiven) {
  const auto g = pure_strata({{"thickness", std::vector<double>{10, 5}},
                              {"hardness", std::vector<double>{0.9, 0.3}},
                              {"elevation", 100.0}});
  EXPECT_EQ(g->resistance({5, 7, 100.01}), 0.9);
  EXPECT_EQ(g->resistance({5, 7, 109.99}), 0.9);
  EXPECT_EQ(g->resistance({5, 7, 110.01}), 0.3);
  EXPECT_EQ(g->resistance({5, 7, 115.01}), 0.9);
  EXPECT_EQ(g->resistance({5, 7, 99.99}), 0.3);
  EXPECT_EQ(g->resistance({5, 7, 94.99}), 0.9);
  EXPECT_EQ(g->resistance({5, 7, 100.01 - 15 * 1000}), 0.9);
}

TEST(Strata, ListsOfDifferentLengthsRepeatOnTheirOwn) {
  const auto g = pure_strata({{"thickness", 2.0}, {"hardness", std::vector<double>{0.1, 0.5, 0.9}}});
  EXPECT_EQ(g->resistance({0, 0, 1}), 0.1);
  EXPECT_EQ(g->resistance({0, 0, 3}), 0.5);
  EXPECT_EQ(g->resistance({0, 0, 5}), 0.9);
  EXPECT_EQ(g->resistance({0, 0, -1}), 0.9);
}

TEST(Strata, ElevationIsWorldElevation) {
  const Values values{{"turbulence", 0.0}, {"waviness", 0.0}};
  const auto low = make_geology("strata", values, {}, {0, 0, 0}, 4);
  const auto high = make_geology("strata", values, {}, {0, 0, 75}, 4);
  for (double z = -40; z < 120; z += 0.5) EXPECT_EQ(low->raw({0, 0, z}), high->raw({0, 0, z - 75}));
}

TEST(Strata, DefaultBedsAlternateBetweenHardAndSoft) {
  // Up a drill hole, beds of 3 to 22 m whose hardness alternates about the middle.
  const auto g = make_geology("strata", {{"turbulence", 0.0}}, {}, none, 21);
  std::vector<double> thicknesses;
  double last = -500;
  bool hard = g->raw({0, 0, -500}) > 0.55;
  for (double z = -500; z < 500; z += 0.05) {
    const bool now = g->raw({0, 0, z}) > 0.55;
    if (now == hard) continue;
    if (last > -500) thicknesses.push_back(z - last);
    last = z;
    hard = now;
  }
  EXPECT_GT(thicknesses.size(), 80u);
  EXPECT_LT(thicknesses.size(), 130u);
  EXPECT_GT(*std::min_element(thicknesses.begin(), thicknesses.end()), 3);
  EXPECT_LT(*std::max_element(thicknesses.begin(), thicknesses.end()), 22);
  EXPECT_NEAR(mean(thicknesses), 39.0 / 4, 0.5);
}

TEST(Strata, TransitionsLeaveNoJumps) {
  const auto g =
      make_geology("strata", {{"turbulence", 0.0}, {"variation", 0.9}, {"transition", 3.0}}, {}, none, 8);
  double last = g->raw({1, 2, -2000});
  for (double z = -2000; z < 2000; z += 0.01) {
    const double now = g->raw({1, 2, z});
    ASSERT_LT(std::abs(now - last), 0.1) << z;
    last = now;
  }
}

TEST(Strata, BedsAreTheSameNearAndFarFromTheFirst) {
  // Beds far away are made anew for each point: a stack moved by many cycles must hold the same beds.
  const Values even = {{"variation", 0.0},
                       {"hardness_variation", 0.0},
                       {"turbulence", 0.0},
                       {"waviness", 0.0},
                       {"thickness", std::vector<double>{0.5, 8, 64, 1}}};
  Values moved = even;
  moved["elevation"] = -73.5 * 256;
  const auto near = make_geology("strata", even, {}, none, 4),
             far = make_geology("strata", moved, {}, none, 4);
  for (double z = -100; z < 300; z += 0.0625) ASSERT_EQ(near->raw({0, 0, z}), far->raw({0, 0, z})) << z;
}

TEST(Strata, BedsDipTowardsTheAzimuth) {
  const auto g = pure_strata({{"thickness", 10.0},
                              {"hardness", std::vector<double>{0.9, 0.1}},
                              {"dip", 45.0},
                              {"azimuth", 90.0},
                              {"position", std::vector<double>{1000, 0}}});
  // A step of one bed eastward goes as deep as it goes far.
  for (double x = 1000; x < 1200; x += 3)
    EXPECT_EQ(g->resistance({x, 50, 5 - (x - 1000)}), g->resistance({1000, 0, 5}));
  EXPECT_EQ(g->resistance({1000, 0, 5}), 0.9);
  EXPECT_EQ(g->resistance({1000, 0, 5 + 10 * std::numbers::sqrt2}), 0.1);
}

TEST(Strata, NeedsABed) {
  EXPECT_EQ(error_of([&] {
              make_geology("strata", {{"thickness", std::vector<double>{}}}, {}, none, 0);
            }),
            "strata: thickness must name at least one bed");
  EXPECT_EQ(error_of([&] {
              make_geology("strata", {{"hardness", std::vector<double>{}}}, {}, none, 0);
            }),
            "strata: hardness must name at least one bed");
}

TEST(Planes, FallOffFromThePlane) {
  const auto g = make_geology("planes",
                              {{"position", std::vector<double>{0, 0, 50}},
                               {"thickness", 10.0},
                               {"spacing", 0.0},
                               {"strength", 0.5},
                               {"base", 0.2},
                               {"turbulence", 0.0}},
                              {}, none, 1);
  EXPECT_DOUBLE_EQ(g->raw({3, 4, 50}), 0.7);
  EXPECT_DOUBLE_EQ(g->raw({3, 4, 55}), 0.2 + 0.5 * 0.421875);
  EXPECT_DOUBLE_EQ(g->raw({3, 4, 60}), 0.2);
  EXPECT_DOUBLE_EQ(g->raw({3, 4, 45}), g->raw({9, 9, 55}));
}

TEST(Planes, RepeatAndDip) {
  const auto g = make_geology(
      "planes", {{"dip", 90.0}, {"azimuth", 0.0}, {"thickness", 2.0}, {"spacing", 8.0}, {"turbulence", 0.0}},
      {}, none, 1);
  // Vertical planes that face north, every 8 m.
  for (double y : {-80.0, -8.0, 0.0, 16.0}) EXPECT_NEAR(g->raw({5, y, 77}), 0.75, 1e-9);
  for (double y : {-4.0, 4.0, 12.0}) EXPECT_NEAR(g->raw({5, y, 77}), 0.15, 1e-9);
}

TEST(Planes, TurbulenceIsThePapersSum) {
  const Values calm{{"turbulence", 0.0}}, rough{{"turbulence", 0.3}};
  const auto a = make_geology("planes", calm, {}, none, 1), b = make_geology("planes", rough, {}, none, 1);
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Vec3d p{random.uniform(0, 99), random.uniform(0, 99), random.uniform(0, 99)};
    EXPECT_GE(b->raw(p) - a->raw(p), 0);
    EXPECT_LE(b->raw(p) - a->raw(p), 0.3);
  }
}

TEST(Turbulence, WithoutLateralChangeDependsOnElevationAlone) {
  const auto g = make_geology("turbulence", {{"lateral", 0.0}}, {}, none, 1);
  double spread = 0;
  for (double z = 0; z < 100; z += 1) {
    EXPECT_EQ(g->raw({0, 0, z}), g->raw({500, -20, z}));
    spread = std::max(spread, std::abs(g->raw({0, 0, z}) - g->raw({0, 0, 0})));
  }
  EXPECT_GT(spread, 0.3);
}

TEST(Turbulence, StaysWithinTheUnitIntervalAndFillsIt) {
  const auto g = make_geology("turbulence", {}, {}, none, 1);
  Random random(1);
  double lo = 1, hi = 0, sum = 0;
  for (int i = 0; i < 20000; ++i) {
    const double r = g->raw({random.uniform(0, 5000), random.uniform(0, 5000), random.uniform(0, 900)});
    lo = std::min(lo, r);
    hi = std::max(hi, r);
    sum += r;
  }
  EXPECT_GE(lo, 0);
  EXPECT_LE(hi, 1);
  EXPECT_LT(lo, 0.1);
  EXPECT_GT(hi, 0.9);
  EXPECT_NEAR(sum / 20000, 0.5, 0.05);
}

TEST(Blend, IsTheSum) {
  const auto a = make_geology("planes", {}, {}, none, 1), b = make_geology("turbulence", {}, {}, none, 2);
  const auto sum = make_geology("blend", {}, {a, b}, none, 0);
  const auto nested = make_geology("blend", {}, {sum, a}, none, 0);
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Vec3d p{random.uniform(0, 99), random.uniform(0, 99), random.uniform(0, 99)};
    EXPECT_EQ(sum->raw(p), a->raw(p) + b->raw(p));
    EXPECT_EQ(nested->raw(p), (a->raw(p) + b->raw(p)) + a->raw(p));
    EXPECT_LE(nested->resistance(p), 1);
  }
}

}  // namespace
}  // namespace tafoni::geology
