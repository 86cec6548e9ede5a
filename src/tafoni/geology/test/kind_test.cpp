#include "tafoni/geology/kind.h"

#include <algorithm>
#include <functional>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/effects.h"

namespace tafoni::geology {
namespace {

using testing::HasSubstr;

std::vector<Vec3d> cloud_of_points(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> points(n);
  for (Vec3d& p : points)
    p = {random.uniform(-300, 300), random.uniform(-300, 300), random.uniform(-80, 200)};
  return points;
}

/// Any kind, with leaves where it wants children.
GeologyPtr any(const GeologyType& type, Vec3d origin, std::uint64_t seed, const Values& values = {}) {
  std::vector<GeologyPtr> children;
  for (std::size_t i = 0; i < type.min_children; ++i)
    children.push_back(make_geology("turbulence", {}, {}, origin, seed + i));
  return make_geology(type.about.name, values, children, origin, seed);
}

/// Whether it only changes rock near a place and adds nothing elsewhere.
bool is_local(const GeologyType& type) {
  const GeologyPtr g = any(type, {}, 9);
  const auto points = cloud_of_points(50, 4);
  return std::all_of(points.begin(), points.end(), [&](Vec3d p) {
    return g->raw(p + Vec3d{5e6, 5e6, 0}) == 0;
  });
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    return e.what();
  }
  return "no error";
}

class EveryKind : public testing::TestWithParam<const GeologyType*> {};

TEST_P(EveryKind, IsDeclaredInFull) {
  const GeologyType& type = *GetParam();
  EXPECT_EQ(&find_geology(type.about.name), &type);
  EXPECT_FALSE(type.about.doc.empty());
  EXPECT_THAT(type.about.source, testing::StartsWith("[Paris19 §4"));
  EXPECT_LE(type.min_children, type.max_children);
  for (const ParamInfo& info : type.about.params) {
    EXPECT_FALSE(info.doc.empty()) << info.name;
    EXPECT_NE(info.doc.back(), '.') << info.name;
    EXPECT_EQ(check_value(info, info.init, type.about.name), info.init) << info.name;
  }
}

TEST_P(EveryKind, EveryParameterDoesSomething) {
  const GeologyType& type = *GetParam();
  auto points = cloud_of_points(600, 12);
  for (std::size_t i = 0; i < points.size() / 2; ++i) points[i] = points[i] * 0.1;
  const auto make = [&](const Values& values) -> std::optional<std::vector<float>> {
    const auto domain = values.find("domain");
    const bool field = domain != values.end() && domain->second == Value(std::string("field"));
    std::vector<GeologyPtr> children;
    for (std::size_t i = 0; i < type.min_children + (field ? 1 : 0); ++i)
      children.push_back(make_geology("turbulence", {}, {}, {}, 20 + i));
    std::vector<float> rho(points.size());
    try {
      make_geology(type.about.name, values, children, {}, 9)->resistances(points, rho);
    } catch (const Error&) {
      return std::nullopt;  // a top that is not above the bottom
    }
    return rho;
  };
  for (const ParamInfo& info : type.about.params) EXPECT_TRUE(has_effect(info, {}, make)) << info.name;
}

TEST_P(EveryKind, ManyPointsGiveWhatOneByOneGives) {
  const auto points = cloud_of_points(3000, 5);
  const GeologyPtr g = any(*GetParam(), {500000, 4000000, 30}, 9);
  std::vector<double> out(points.size());
  g->raws(points, out);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(out[i], g->raw(points[i]));
  std::vector<float> rho(points.size());
  g->resistances(points, rho);
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_EQ(rho[i], static_cast<float>(g->resistance(points[i])));
}

TEST_P(EveryKind, DoesNotDependOnTheOrigin) {
  const Vec3d a{400000, 3800000, 0}, b{400256, 3799872, 64};
  const GeologyPtr in_a = any(*GetParam(), a, 3), in_b = any(*GetParam(), b, 3);
  for (Vec3d p : cloud_of_points(500, 6)) {
    p = {std::floor(p.x), std::floor(p.y), std::floor(p.z)};  // exact in either frame
    ASSERT_EQ(in_a->raw(p), in_b->raw(p + a - b));
  }
}

TEST_P(EveryKind, SeedsChangeTheRock) {
  const GeologyPtr a = any(*GetParam(), {}, 1), b = any(*GetParam(), {}, 1), c = any(*GetParam(), {}, 2);
  const double size = is_local(*GetParam()) ? 0.1 : 1;
  double differ = 0;
  for (Vec3d p : cloud_of_points(200, 7)) {
    p = p * size;
    ASSERT_EQ(a->raw(p), b->raw(p));
    differ += std::abs(a->raw(p) - c->raw(p));
  }
  EXPECT_GT(differ / 200, 0.01);
}

TEST_P(EveryKind, UsesTheRangeOfResistance) {
  // Those that act about a place reach 30 m and add 0.6 by default, to the rock of others; the points asked
  // for lie up to 470 m from there, so these kinds are made to span them and to be hard rock of their own.
  Values values;
  if (is_local(*GetParam())) values = {{"radius", 450.0}, {"strength", 1.0}};
  const GeologyPtr g = any(*GetParam(), {}, 11, values);
  auto points = cloud_of_points(20000, 8);
  std::vector<float> rho(points.size());
  g->resistances(points, rho);
  std::sort(rho.begin(), rho.end());
  EXPECT_GE(rho.front(), 0);
  EXPECT_LE(rho.back(), 1);
  EXPECT_GT(rho[rho.size() * 9 / 10] - rho[rho.size() / 10], 0.35) << "too even to show beds";
  const auto saturated = std::count_if(rho.begin(), rho.end(), [](float r) { return r <= 0 || r >= 1; });
  EXPECT_LT(saturated, 4000);
}

TEST_P(EveryKind, RejectsUnknownParametersAndChildren) {
  const GeologyType& type = *GetParam();
  std::vector<GeologyPtr> children(type.max_children + 1, make_geology("turbulence", {}, {}, {}, 0));
  EXPECT_THAT(error_of([&] { make_geology(type.about.name, {}, children, {}, 0); }),
              HasSubstr(fmt::format(", but has {}", type.max_children + 1)));
  children.resize(type.min_children);
  EXPECT_THAT(error_of([&] {
                make_geology(type.about.name, {{"nonsense", 1.0}}, children, {}, 0);
              }),
              HasSubstr(type.about.name + ": unknown parameter \"nonsense\""));
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryKind,
                         testing::ValuesIn(all_geologies().begin(), all_geologies().end()),
                         [](const auto& tested) { return tested.param->about.name; });

TEST(Kind, UnknownNameGetsTheNearest) {
  EXPECT_EQ(error_of([] { find_geology("starta"); }),
            "there is no geology \"starta\"; did you mean \"strata\"?");
  EXPECT_THAT(error_of([] { find_geology("granite"); }),
              HasSubstr("there is no geology \"granite\"; known are blend, "));
}

TEST(Kind, SaysHowManyChildrenItTakes) {
  const auto error = [](const char* name, std::size_t n) {
    return error_of([&] {
      make_geology(name, {}, std::vector<GeologyPtr>(n, make_geology("planes", {}, {}, {}, 0)), {}, 0);
    });
  };
  EXPECT_EQ(error("strata", 1), "strata: takes no children, but has 1");
  EXPECT_EQ(error("fold", 0), "fold: takes 1 child, but has none");
  EXPECT_EQ(error("fault", 3), "fault: takes 1 or 2 children, but has 3");
  EXPECT_EQ(error("fault", 2), "fault: with domain = \"plane\" it takes 1 child, but has 2");
  EXPECT_EQ(error("contact", 3), "contact: with domain = \"plane\" it takes 2 children, but has 3");
}

TEST(Kind, DefaultGeologyIsStrata) {
  const Vec3d p{3, 4, 5};
  EXPECT_EQ(default_geology({}, 3)->raw(p), make_geology("strata", {}, {}, {}, 3)->raw(p));
}

}  // namespace
}  // namespace tafoni::geology
