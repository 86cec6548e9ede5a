#include "tafoni/geology/impl/domain.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/geology/test/rocks.h"

namespace tafoni::geology {
namespace {

/// 1 inside, 0 outside.
GeologyPtr inside(Values values) {
  return make_geology("contact", values, {rock([](Vec3d) { return 0.0; }), rock([](Vec3d) { return 1.0; })},
                      {}, 0);
}

Values with(const char* domain, Values values) {
  values["domain"] = std::string(domain);
  return values;
}

TEST(Domain, PlaneIsTheSideAboveWithoutThePlane) {
  const auto g = inside({{"position", std::vector<double>{8, 0, 2}}, {"dip", 90.0}, {"azimuth", 90.0}});
  EXPECT_EQ(g->raw({8, 5, 5}), 0);
  EXPECT_EQ(g->raw({std::nextafter(8.0, 9.0), 5, 5}), 1);
  EXPECT_EQ(g->raw({std::nextafter(8.0, 7.0), 5, 5}), 0);
  const auto flat = inside({{"position", std::vector<double>{0, 0, 2}}, {"dip", 0.0}});
  EXPECT_EQ(flat->raw({1, 1, 2}), 0);
  EXPECT_EQ(flat->raw({1, 1, 2.001}), 1);
}

TEST(Domain, SphereEndsExactlyAtItsRadius) {
  const auto g = inside(with("sphere", {{"position", std::vector<double>{10, 20, 30}}, {"radius", 5.0}}));
  EXPECT_EQ(g->raw({15, 20, 30}), 0);
  EXPECT_EQ(g->raw({std::nextafter(15.0, 10.0), 20, 30}), 1);
  EXPECT_EQ(g->raw({13, 20, 34}), 0);
  EXPECT_EQ(g->raw({13, 20, 33.999}), 1);
}

TEST(Domain, BoxTurnsWithItsAzimuth) {
  const std::vector<double> size = {10, 40, 6};
  const auto g =
      inside(with("box", {{"position", std::vector<double>{1, 2, 3}}, {"size", size}, {"azimuth", 0.0}}));
  EXPECT_EQ(g->raw({6, 2, 3}), 0);
  EXPECT_EQ(g->raw({5.999, 21.999, 5.999}), 1);
  EXPECT_EQ(g->raw({1, 22, 3}), 0);
  EXPECT_EQ(g->raw({1, 2, 0}), 0);
  // Its length points east now.
  const auto turned =
      inside(with("box", {{"position", std::vector<double>{1, 2, 3}}, {"size", size}, {"azimuth", 90.0}}));
  EXPECT_EQ(turned->raw({20, 2, 3}), 1);
  EXPECT_EQ(turned->raw({1, 20, 3}), 0);
  const auto slanted =
      inside(with("box", {{"position", std::vector<double>{0, 0, 0}}, {"size", size}, {"azimuth", 30.0}}));
  EXPECT_EQ(slanted->raw({19 * 0.5, 19 * std::numbers::sqrt3 / 2, 0}), 1);
  EXPECT_EQ(slanted->raw({-19 * 0.5, 19 * std::numbers::sqrt3 / 2, 0}), 0);
}

TEST(Domain, PolygonIsAnOpenPrism) {
  const auto g = inside(with(
      "polygon",
      {{"polygon", std::vector<double>{0, 0, 10, 0, 10, 10, 5, 4, 0, 10}}, {"bottom", -5.0}, {"top", 5.0}}));
  EXPECT_EQ(g->raw({1, 5, 0}), 1);
  EXPECT_EQ(g->raw({9, 5, 0}), 1);
  EXPECT_EQ(g->raw({5, 5, 0}), 0) << "in the notch";
  EXPECT_EQ(g->raw({5, 3, 0}), 1);
  EXPECT_EQ(g->raw({5, 3, 5}), 0);
  EXPECT_EQ(g->raw({5, 3, -5}), 0);
  for (const Vec3d border :
       {Vec3d{5, 0, 0}, {0, 5, 0}, {10, 5, 0}, {0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {5, 4, 0}})
    EXPECT_EQ(g->raw(border), 0) << border.x << ' ' << border.y;
}

TEST(Domain, FieldIsWhereTheLastChildIsAboveAHalf) {
  const auto slope = rock([](Vec3d p) { return p.x / 100; });
  const auto zero = rock([](Vec3d) { return 0.0; }), one = rock([](Vec3d) { return 1.0; });
  const auto g = make_geology("contact", with("field", {}), {zero, one, slope}, {}, 0);
  EXPECT_EQ(g->raw({50, 0, 0}), 0);
  EXPECT_EQ(g->raw({50.001, 0, 0}), 1);
  const auto moved = make_geology("fault", with("field", {{"throw", std::vector<double>{0, 0, 5}}}),
                                  {rock([](Vec3d p) { return p.z; }), slope}, {}, 0);
  EXPECT_EQ(moved->raw({49, 0, 7}), 7);
  EXPECT_EQ(moved->raw({51, 0, 7}), 2);
}

TEST(Domain, SaysWhatIsWrongWithAPolygon) {
  const auto error = [](const Values& values) { return error_of([&] { inside(with("polygon", values)); }); };
  EXPECT_EQ(error({}), "contact: polygon has 0 numbers, but needs x, y of three corners or more");
  EXPECT_EQ(error({{"polygon", std::vector<double>{0, 0, 1, 0, 1, 1, 4}}}),
            "contact: polygon has 7 numbers, but needs x, y of three corners or more");
  EXPECT_EQ(error({{"polygon", std::vector<double>{0, 0, 1, 0, 1, 1}}, {"bottom", 3.0}, {"top", 3.0}}),
            "contact: bottom = 3 is not below top = 3");
}

TEST(Fault, OnEitherSideIsTheUnfaultedRockMovedOrNot) {
  const auto strata = make_geology("strata", {}, {}, {}, 2);
  const Vec3d at{5, 6, 7}, slip{3, -2, -20};
  const auto g = make_geology("fault",
                              {{"position", std::vector<double>{at.x, at.y, at.z}},
                               {"dip", 60.0},
                               {"azimuth", 45.0},
                               {"throw", std::vector<double>{slip.x, slip.y, slip.z}}},
                              {strata}, {}, 0);
  const double d = std::numbers::pi / 3, a = std::numbers::pi / 4;
  const Vec3d normal{std::sin(d) * std::sin(a), std::sin(d) * std::cos(a), std::cos(d)};
  int moved = 0;
  for (Vec3d p : scattered(1000, 100, 7)) {
    const bool hanging = dot(p - at, normal) > 0;
    moved += hanging;
    ASSERT_EQ(g->raw(p), strata->raw(hanging ? p - slip : p));
  }
  EXPECT_GT(moved, 300);
  EXPECT_LT(moved, 700);
}

TEST(Fault, TearsSmoothRockAlongThePlaneAndNowhereElse) {
  const auto g = make_geology("fault", {{"dip", 45.0}, {"throw", std::vector<double>{0, 0, -8}}},
                              {rock([](Vec3d p) { return p.z; })}, {}, 0);
  // The plane descends eastward: at elevation 10 it is met at x = -10.
  double last = g->raw({-60, 3, 10});
  int tears = 0;
  for (double x = -59.995; x < 60; x += 0.01) {
    const double now = g->raw({x, 3, 10});
    if (std::abs(now - last) > 0.5) {
      EXPECT_NEAR(x, -10, 0.011);
      EXPECT_EQ(now - last, 8);
      ++tears;
    }
    last = now;
  }
  EXPECT_EQ(tears, 1);
}

TEST(Fault, FaultsCutFaults) {
  const auto height = rock([](Vec3d p) { return p.z; });
  const Values east = {{"dip", 90.0}, {"throw", std::vector<double>{0, 0, -4}}};
  const Values north = {{"dip", 90.0}, {"azimuth", 0.0}, {"throw", std::vector<double>{0, 0, -10}}};
  const auto g = make_geology("fault", north, {make_geology("fault", east, {height}, {}, 0)}, {}, 0);
  EXPECT_EQ(g->raw({-1, -1, 0}), 0);
  EXPECT_EQ(g->raw({1, -1, 0}), 4);
  EXPECT_EQ(g->raw({-1, 1, 0}), 10);
  EXPECT_EQ(g->raw({1, 1, 0}), 14);
}

TEST(Contact, EachSideIsItsOwnRock) {
  const auto left = make_geology("turbulence", {}, {}, {}, 2);
  const auto right = make_geology("fold", {}, {make_geology("strata", {}, {}, {}, 5)}, {}, 4);
  const auto g = make_geology("contact", {{"dip", 90.0}}, {left, right}, {}, 0);
  for (Vec3d p : scattered(500, 100, 8)) ASSERT_EQ(g->raw(p), (p.x > 0 ? right : left)->raw(p));
}

}  // namespace
}  // namespace tafoni::geology
