// The landform prism-field, beyond what every landform is asked (landform_test.cpp).

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

using testing::HasSubstr;

Result dug(const Site& site, const Values& values) {
  return find_landform("prism-field").generate(site, values, silent());
}

/// A ridge along y, 24 m high and some 40 m wide.
test::Coast ridge() {
  return test::Coast(
      [](Vec3d) { return 0.3; },
      [](double x, double y) { return 24 * std::exp(-x * x / 200) + 0.2 * std::sin(0.3 * y); });
}

TEST(PrismField, WithoutToolsIsTheTerrain) {
  const test::Coast coast;
  const Result result = dug(coast.site, {{"count", std::int64_t{0}}, {"spacing", 0.5}});
  const auto before = field::compile(coast.site.terrain), after = test::carved(coast.site, result);
  // Rock stays rock and air air, but for what a column's spacing hides.
  int rock = 0;
  for (const Vec3d p : test::places({{-50, -35, -15}, {50, 35, 40}}, 20000, 1)) {
    const float was = before.value(p), is = after.value(p);
    if (std::abs(was) < 0.4f) continue;
    EXPECT_EQ(was > 0, is > 0) << p.x << ", " << p.y << ", " << p.z << ": " << was;
    rock += was > 0;
  }
  EXPECT_GT(rock, 5000);
}

TEST(PrismField, RowsDigAndBuildInOrder) {
  const test::Coast coast;  // its origin is (500000, 4000000, 0)
  const Rows rows{
      {{"tool", "box"}, {"at", "500000 4000030 20"}, {"size", "10 10 10"}},
      {{"tool", "sphere"}, {"mode", "add"}, {"at", "500000, 4000030, 20"}, {"radius", "3"}},
      {{"tool", "capsule"}, {"at", "499980 4000020 15"}, {"to", "500010 4000020 15"}, {"radius", "2"}},
      {{"tool", "hull"},
       {"mode", "add"},
       {"points", "500018 4000000 40, 500022 4000000 40, 500020 4000004 40, 500020 4000002 44"}}};
  Values values{{"count", std::int64_t{0}}, {"spacing", 0.5}};
  const auto& infos = find_landform("prism-field").about.params;
  values["tool"] = check_value(find_param(infos, "tool", "prism-field"), Value(rows), "prism-field");
  const Result result = dug(coast.site, values);
  EXPECT_EQ(test::fact<std::int64_t>(result, "tools"), 4);
  const auto field = test::carved(coast.site, result);
  EXPECT_GT(field.value({0, 30, 20}), 1);       // the ball
  EXPECT_LT(field.value({4, 30, 20}), 0);       // around it
  EXPECT_GT(field.value({0, 30, 10}), 1);       // below the hollow
  EXPECT_LT(field.value({-10, 20, 15}), -1);    // in the tunnel
  EXPECT_GT(field.value({-10, 20, 20}), 1);     // over it
  EXPECT_GT(field.value({20, 1.5, 41}), 0.3f);  // floating
  EXPECT_LT(field.value({20, 1.5, 37}), 0);
}

TEST(PrismField, BoxAloneStandsInPlaceOfTheTerrain) {
  const test::Coast coast;
  const Result result = dug(coast.site, {{"source", std::string("box")},
                                         {"alone", true},
                                         {"at", std::vector<double>{500000, 4000000, 50}},
                                         {"size", std::vector<double>{20, 16, 10}},
                                         {"spacing", 0.5},
                                         {"count", std::int64_t{0}}});
  const auto field = test::carved(coast.site, result);
  for (const Vec3d p : test::places({{-20, -20, 0}, {20, 20, 70}}, 5000, 2)) {
    const double in = std::min({10 - std::abs(p.x), 8 - std::abs(p.y), 5 - std::abs(p.z - 55)});
    if (std::abs(in) < 0.6) continue;
    EXPECT_EQ(in > 0, field.value(p) > 0) << p.x << ", " << p.y << ", " << p.z;
  }
}

TEST(PrismField, TunnelLeadsThroughTheHill) {
  const test::Coast land = ridge();
  const double radius = 2.5;
  const Result result =
      dug(land.site, {{"count", std::int64_t{0}}, {"spacing", 0.5}, {"tunnel", radius}, {"cover", 14.0}});
  const std::vector<Vec3d> mouths = test::fact<Places>(result, "mouths").local;
  ASSERT_EQ(mouths.size(), 2u);
  const Vec3d a = mouths[0], b = mouths[1];
  EXPECT_LT(a.x * b.x, 0);  // on either side of the ridge
  EXPECT_LT(length(b - a), 60);
  const auto field = test::carved(land.site, result);
  const auto before = field::compile(land.site.terrain);
  int covered = 0;
  for (int n = 0; n <= 200; ++n) {
    const Vec3d p = a + (b - a) * (n / 200.0);
    covered += before.value(p) > 2;
    // Room for a walker 1.8 m high, on a floor that is there.
    for (const double up : {-2.0, -1.0, 0.0, 1.0, 2.0})
      EXPECT_LT(field.value(p + Vec3d{0, 0, up}), 0) << n << ": " << up;
    EXPECT_GT(field.value(p - Vec3d{0, 0, radius + 0.4}), 0) << n;
  }
  EXPECT_GT(covered, 100);
}

// Columns finer than the terrain's pixels show the same tunnel more finely.
TEST(PrismField, TunnelsPlaceDoesNotDependOnTheSpacing) {
  const test::Coast land = ridge();
  const auto mouths = [&](double spacing) {
    return test::fact<Places>(
               dug(land.site,
                   {{"count", std::int64_t{0}}, {"spacing", spacing}, {"tunnel", 2.5}, {"cover", 14.0}}),
               "mouths")
        .local;
  };
  ASSERT_EQ(mouths(1).size(), 2u);
  EXPECT_EQ(mouths(1), mouths(0.6));
  EXPECT_EQ(mouths(1), mouths(0.35));
}

// Upright faces lie between the planes of a scene's lattice: on a plane they would fall from voxel to voxel.
TEST(PrismField, FacesLieOffTheLattice) {
  const test::Coast coast;
  const double spacing = 0.5;
  const Result result = dug(coast.site, {{"source", std::string("box")},
                                         {"alone", true},
                                         {"at", std::vector<double>{500000, 4000000, 50}},
                                         {"size", std::vector<double>{20, 16, 10}},
                                         {"spacing", spacing},
                                         {"rounding", 0.0},
                                         {"count", std::int64_t{0}}});
  const auto field = test::carved(coast.site, result);
  for (const double voxel : {spacing, spacing / 2, spacing / 3, spacing / 4})
    for (double x = -11; x < 11; x += voxel)
      for (double y = -9; y < 9; y += voxel)
        EXPECT_GT(std::abs(field.value({x, y, 55.1})), 0.1 * voxel) << x << ", " << y;
}

TEST(PrismField, BadRowsGetOneSentence) {
  const test::Coast coast;
  const auto error = [&](Row row) -> std::string {
    const auto& infos = find_landform("prism-field").about.params;
    Values values{{"count", std::int64_t{0}}};
    try {
      values["tool"] =
          check_value(find_param(infos, "tool", "prism-field"), Value(Rows{std::move(row)}), "prism-field");
      dug(coast.site, values);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::usage);
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error({{"tool", "cone"}}),
              HasSubstr("prism-field: tool, row 1: tool = \"cone\" is not one of"));
  EXPECT_THAT(error({{"mode", "dig"}}), HasSubstr("mode = \"dig\" is not one of remove | add"));
  EXPECT_THAT(error({{"at", "1 2"}, {"radius", "1"}}), HasSubstr("at must be 3 numbers"));
  EXPECT_THAT(error({{"radius", "1"}}), HasSubstr("prism-field: tool, row 1: it needs at"));
  EXPECT_THAT(error({{"at", "1 2 3"}}), HasSubstr("prism-field: tool, row 1: it needs a number for radius"));
  EXPECT_THAT(error({{"at", "1 2 3"}, {"radius", "1e7"}}), HasSubstr("radius = 10000000 is outside"));
  EXPECT_THAT(error({{"tool", "hull"}, {"points", "0 0 0 1"}}), HasSubstr("a hull needs points"));
  EXPECT_THAT(error({{"tool", "hull"}, {"points", "0 0 0 1 0 0 0 1 0 1 1 0"}}), HasSubstr("lie in a plane"));
}

}  // namespace
}  // namespace tafoni::landforms
