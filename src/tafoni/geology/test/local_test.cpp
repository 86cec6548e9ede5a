#include "tafoni/geology/impl/local.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/geology/test/rocks.h"

namespace tafoni::geology {
namespace {

double g(double r) {
  return r < 1 ? std::pow(1 - r * r, 3) : 0;
}

Values smooth(Values values) {
  values.insert({{"roughness", 0.0}, {"radius", 20.0}, {"strength", 0.5}});
  return values;
}

TEST(Sphere, FallsOffFromItsCentre) {
  const auto s = make_geology("sphere", smooth({{"position", std::vector<double>{10, 20, 30}}}), {}, {}, 0);
  EXPECT_EQ(s->raw({10, 20, 30}), 0.5);
  for (Vec3d p : scattered(500, 25, 1))
    EXPECT_NEAR(s->raw(p + Vec3d{10, 20, 30}), 0.5 * g(length(p) / 20), 1e-12);
  EXPECT_EQ(s->raw({30, 20, 30}), 0);
}

TEST(Sphere, IsFullWithinItsCore) {
  const auto s = make_geology("sphere", smooth({{"core", 8.0}, {"strength", -0.7}}), {}, {}, 0);
  EXPECT_EQ(s->raw({0, 0, 7.9}), -0.7);
  EXPECT_NEAR(s->raw({0, 14, 0}), -0.7 * g(0.5), 1e-12);
  const auto hard = make_geology("sphere", smooth({{"core", 20.0}}), {}, {}, 0);
  EXPECT_EQ(hard->raw({0, 0, 19.999}), 0.5);
  EXPECT_EQ(hard->raw({0, 0, 20.001}), 0);
}

TEST(Sphere, OfSeveralCentresTheNearestActs) {
  const auto s =
      make_geology("sphere", smooth({{"position", std::vector<double>{0, 0, 0, 30, 0, 0}}}), {}, {}, 0);
  for (double x = -20; x <= 50; x += 0.5)
    EXPECT_NEAR(s->raw({x, 0, 0}), 0.5 * g(std::min(std::abs(x), std::abs(x - 30)) / 20), 1e-12);
}

TEST(Sphere, NoiseMovesItsBorderWithinTheRoughness) {
  const auto s =
      make_geology("sphere", {{"radius", 20.0}, {"roughness", 0.4}, {"wavelength", 8.0}}, {}, {}, 5);
  double nearest = 99, farthest = 0;
  for (Vec3d p : scattered(300, 1, 6)) {
    const Vec3d u = normalized(p);
    double last = s->raw({0, 0, 0}), border = 0;
    EXPECT_EQ(last, 0.6);
    for (double r = 0.1; r < 30; r += 0.1) {
      const double now = s->raw(u * r);
      ASSERT_LE(now, last + 1e-12) << "not falling outwards";
      if (now > 0) border = r;
      last = now;
    }
    nearest = std::min(nearest, border);
    farthest = std::max(farthest, border);
  }
  EXPECT_GE(nearest, 11.8);
  EXPECT_LE(farthest, 28);
  EXPECT_GT(farthest - nearest, 4);
}

TEST(Curve, FallsOffFromItsNearestPiece) {
  const auto c = make_geology(
      "curve", smooth({{"position", std::vector<double>{0, 0, 0, 50, 0, 0, 50, 40, 0}}, {"smooth", false}}),
      {}, {}, 0);
  EXPECT_NEAR(c->raw({25, 0, 10}), 0.5 * g(0.5), 1e-12);
  EXPECT_NEAR(c->raw({60, 20, 0}), 0.5 * g(0.5), 1e-12);
  EXPECT_NEAR(c->raw({-6, 8, 0}), 0.5 * g(0.5), 1e-12) << "round about its end";
  EXPECT_EQ(c->raw({25, 20, 0}), 0);
}

TEST(Curve, SmoothCurvesPassThroughTheirPlacesWithoutCorners) {
  const std::vector<double> places = {0, 0, 0, 40, 0, 0, 40, 40, 0, 80, 40, 20};
  const auto c = make_geology("curve", smooth({{"position", places}}), {}, {}, 0);
  for (std::size_t i = 0; i < places.size(); i += 3)
    EXPECT_NEAR(c->raw({places[i], places[i + 1], places[i + 2]}), 0.5, 1e-12);
  // Straight pieces would cut the corner at 40, 0; a smooth curve swings outside of it.
  const auto straight = make_geology("curve", smooth({{"position", places}, {"smooth", false}}), {}, {}, 0);
  EXPECT_GT(c->raw({44, 0, 0}), straight->raw({44, 0, 0}));
}

TEST(Curve, SaysWhatIsWrongWithItsPlaces) {
  const auto error = [](const char* kind, const std::vector<double>& numbers) {
    return error_of([&] { make_geology(kind, {{"position", numbers}}, {}, {}, 0); });
  };
  EXPECT_EQ(error("curve", {1, 2, 3}),
            "curve: position has 3 numbers, but needs x, y, z of 2 places or more");
  EXPECT_EQ(error("sphere", {1, 2}),
            "sphere: position has 2 numbers, but needs x, y, z of one place or more");
}

TEST(Local, BlendsWithTheRockAboutItAndIsClampedAtTheEnd) {
  const auto strata = make_geology("strata", {}, {}, {}, 1);
  const auto sphere = make_geology("sphere", {{"strength", 2.0}, {"core", 10.0}}, {}, {}, 2);
  const auto hole = make_geology("sphere", {{"strength", -2.0}, {"core", 10.0}}, {}, {}, 2);
  const auto harder = make_geology("blend", {}, {strata, sphere}, {}, 0);
  const auto none = make_geology("blend", {}, {strata, sphere, hole}, {}, 0);
  EXPECT_EQ(harder->resistance({0, 0, 3}), 1);
  for (Vec3d p : scattered(500, 40, 3)) {
    ASSERT_EQ(harder->raw(p), strata->raw(p) + sphere->raw(p));
    ASSERT_EQ(harder->resistance(p), std::clamp(strata->raw(p) + sphere->raw(p), 0.0, 1.0));
    // Only the sum is clamped: what two children add and take away leaves the third as it was.
    ASSERT_NEAR(none->raw(p), strata->raw(p), 1e-12);
  }
}

}  // namespace
}  // namespace tafoni::geology
