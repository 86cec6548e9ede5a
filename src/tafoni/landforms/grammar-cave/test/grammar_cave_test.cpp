#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

/// A hillside of 30 m over a plain.
double hill(double x, double y) {
  const double t = std::clamp((y + 20 + 3 * std::sin(x / 9)) / 24, 0.0, 1.0);
  return 30 * t * t * (3 - 2 * t);
}

struct Hill : test::Coast {
  explicit Hill(std::uint64_t seed = 5)
      : test::Coast([](Vec3d p) { return 0.5 + 0.4 * std::sin(p.z); }, &hill) {
    site.seed = seed;
  }
  Result run(Values values) const {
    values.try_emplace("size", 3.5);
    return find_landform("grammar-cave").generate(site, values, silent());
  }
  std::vector<Vec3d> route(const Result& result) const { return test::fact<Places>(result, "route").local; }
};

TEST(GrammarCave, TheRouteLeadsFromOutsideUnderTheHillWithRoomToWalk) {
  int deep = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Hill hill(seed);
    const Result result = hill.run({});
    const auto field = test::carved(hill.site, result), before = field::compile(hill.site.terrain);
    const std::vector<Vec3d> route = hill.route(result);
    ASSERT_GE(route.size(), 3u) << seed;
    EXPECT_LT(before.value(route.front() + Vec3d{0, 0, 0.5}), 0) << "begins in the open";
    deep += before.value(route.back() + Vec3d{0, 0, 4}) > 0;
    for (std::size_t i = 0; i + 1 < route.size(); ++i) {
      const Vec3d way = route[i + 1] - route[i];
      const double plan = std::hypot(way.x, way.y);
      EXPECT_LE(std::abs(way.z), 0.51 * plan + 1e-9) << seed << " stretch " << i;
      for (double t = 0; t <= 1; t += 0.2 / std::max(1.0, plan)) {
        const Vec3d p = route[i] + way * t;
        for (double up = 0.4; up <= 2.4; up += 0.2)
          ASSERT_LT(field.value(p + Vec3d{0, 0, up}), 0) << seed << " stretch " << i << " up " << up;
        // In the cave there is a floor to stand on.
        if (i > 0) {
          ASSERT_GT(field.value(p - Vec3d{0, 0, 0.4}), 0) << seed << " stretch " << i;
        }
      }
    }
  }
  EXPECT_GE(deep, 35);
}

TEST(GrammarCave, KeepsItsRoof) {
  int carved = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Hill hill(seed);
    const Result result = hill.run({{"roof", 4.0}, {"roughness", 0.0}, {"bedding", 0.0}});
    const auto after = test::carved(hill.site, result), before = field::compile(hill.site.terrain);
    const std::vector<Vec3d> route = hill.route(result);
    const Vec3d passage = route[2] - route[1], inward = normalized(passage);
    for (const Vec3d p : test::places({{-60, -20, 0}, {60, 40, 20}}, 60000, seed)) {
      if (after.value(p) >= 0 || before.value(p) < 0) continue;
      // The entrance passage itself comes to light.
      if (dot(p - route[1], inward) < length(passage)) continue;
      ++carved;
      // Ground between the places that are looked at, a metre apart, may dip by centimetres.
      ASSERT_GT(before.value(p + Vec3d{0, 0, 3.98}), 0) << seed << ": " << p.x << ' ' << p.y << ' ' << p.z;
    }
  }
  EXPECT_GT(carved, 1000);
}

TEST(GrammarCave, AddsNoRockAndTheCastIsWhatItTakesOut) {
  const Hill hill;
  const auto carved = test::carved(hill.site, hill.run({})),
             cast = test::carved(hill.site, hill.run({{"mode", "cast"}}));
  const auto before = field::compile(hill.site.terrain);
  for (const Vec3d p : test::places({{-60, -45, -15}, {60, 45, 45}}, 30000, 2)) {
    const float b = before.value(p), a = carved.value(p);
    ASSERT_LE(a, b);
    ASSERT_EQ(cast.value(p) > 0, b > 0 && a < 0);
  }
}

TEST(GrammarCave, WearsTheEdgeOfItsEntranceAlone) {
  const Hill hill;
  const double size = 3.5, lip = 0.4;
  const auto sharp = test::carved(hill.site, hill.run({{"lip", 0.0}})),
             worn = test::carved(hill.site, hill.run({{"lip", lip}}));
  const auto before = field::compile(hill.site.terrain);
  int less = 0;
  for (const Vec3d p : test::places({{-60, -30, -5}, {60, 20, 15}}, 300000, 4)) {
    const float a = sharp.value(p), b = worn.value(p);
    ASSERT_LE(b, a);
    ASSERT_GE(b, a - lip * size / 4 - 1e-5);
    if (a > 0 && b < 0) {
      ++less;
      ASSERT_LT(before.value(p), lip * size);
    }
  }
  EXPECT_GT(less, 5);
}

TEST(GrammarCave, ASolidStandsWhereItIsPutAloneOrWithTheTerrain) {
  const Hill hill;
  const std::vector<double> at = {hill.site.origin.x + 5, hill.site.origin.y - 10, 60};
  const Values values = {{"mode", "solid"}, {"at", at}, {"roughness", 0.0}, {"bedding", 0.0}};
  Values alone = values;
  alone["alone"] = true;
  const auto with = test::carved(hill.site, hill.run(values)),
             only = test::carved(hill.site, hill.run(alone));
  const auto before = field::compile(hill.site.terrain);
  Box3d seen;
  for (const Vec3d p : test::places({{-60, -45, -15}, {60, 45, 100}}, 100000, 3)) {
    ASSERT_EQ(with.value(p) > 0, before.value(p) > 0 || only.value(p) > 0);
    if (only.value(p) > 0) seen.expand(p);
  }
  EXPECT_NEAR(seen.center().x, 5, 2);
  EXPECT_NEAR(seen.center().y, -10, 2);
  EXPECT_NEAR(seen.center().z, 60, 2);
}

TEST(GrammarCave, TheEntranceCanBeGiven) {
  const Hill hill;
  const std::vector<double> at = {hill.site.origin.x - 30, hill.site.origin.y - 16, 0};
  const Result result = hill.run({{"at", at}});
  const Vec3d mouth = test::fact<Places>(result, "entrances").local.at(0) + hill.site.origin;
  EXPECT_EQ(mouth.x, at[0]);
  EXPECT_EQ(mouth.y, at[1]);
  const std::vector<Vec3d> route = hill.route(result);
  EXPECT_GT(route[2].y, route[1].y + 4) << "a bearing of 0 leads north";
  EXPECT_NEAR(route[2].x, route[1].x, 1e-6);
  EXPECT_EQ(error_of([&] {
              hill.run({{"at", std::vector<double>{1, 2, 3, 4}}});
            }),
            "grammar-cave: at must hold x and y, and a bearing if wanted");
}

TEST(GrammarCave, RulesMakeTheCave) {
  const Hill hill;
  Rows rules = {{{"symbol", "Hall"}, {"shape", "ellipsoid"}, {"size", "1.2 1 0.8"}, {"next", "Hall"}}};
  ParamInfo info;
  for (const ParamInfo& param : find_landform("grammar-cave").about.params)
    if (param.name == "rule") info = param;
  const Value checked_rules = check_value(info, rules, "test");
  const Result result = hill.run({{"rule", checked_rules}, {"classic", std::int64_t{4}}});
  // Four of the rules and two of the entrance.
  EXPECT_LE(test::fact<std::int64_t>(result, "elements"), 6);
  EXPECT_GE(test::fact<std::int64_t>(result, "productions"), 3);
  EXPECT_LE(test::fact<std::int64_t>(result, "classic"), 4);
  Rows bad = {{{"symbol", "Hall"}, {"shape", "elipsoid"}}};
  EXPECT_THAT(error_of([&] {
                hill.run({{"rule", check_value(info, bad, "test")}});
              }),
              testing::HasSubstr("elipsoid"));
}

TEST(GrammarCave, LevelGroundHasNoEntrance) {
  test::Coast plain([](Vec3d) { return 0.5; }, [](double, double) { return 0.0; });
  const Result result = find_landform("grammar-cave").generate(plain.site, {}, silent());
  EXPECT_FALSE(result.reshape);
  EXPECT_EQ(test::fact<std::int64_t>(result, "productions"), 0);
}

}  // namespace
}  // namespace tafoni::landforms
