#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms::test {
namespace {

Result blown(const Site& site, const Values& values) {
  return find_landform("explosions").generate(site, values, silent());
}

Coast meadow() {
  return Coast([](Vec3d) { return 0.5; }, [](double, double) { return 0.0; });
}

TEST(Explosions, OpenACraterOfTheirRadiusAndLeaveTheRest) {
  const Coast coast = meadow();
  const Rows blast = {{{"at", "500010, 4000005, 0"}, {"radius", "6"}}};
  const Values values = {{"count", std::int64_t{0}}, {"blast", blast}, {"roughness", 0.0}, {"rim", 0.0}};
  const auto before = field::compile(coast.site.terrain),
             after = carved(coast.site, blown(coast.site, values));
  const Vec3d at{10, 5, 0};
  // Straight down the crater ends at the radius, as the rock's value there is its depth.
  EXPECT_LT(after.value(at - Vec3d{0, 0, 5.7}), 0);
  EXPECT_GT(after.value(at - Vec3d{0, 0, 6.4}), 0);
  for (const Vec3d& p : places({{-50, -40, -20}, {50, 40, 20}}, 20000, 1)) {
    ASSERT_LE(after.value(p), before.value(p)) << "only more open space";
    if (length(p - at) > 1.6 * 6) {
      ASSERT_EQ(after.value(p), before.value(p));
    }
  }
}

TEST(Explosions, ThrowOutARimAtTheSurfaceButNotInTheDeep) {
  const Coast coast = meadow();
  const auto highest = [&](const char* at) {
    const Rows blast = {{{"at", at}, {"radius", "5"}}};
    const auto field = carved(coast.site, blown(coast.site, {{"count", std::int64_t{0}}, {"blast", blast}}));
    double top = -1;
    for (double x = -12; x <= 12; x += 0.5)
      for (double y = -12; y <= 12; y += 0.5)
        for (double z = 0; z < 4; z += 0.1)
          if (field.value({x, y, z}) > 0) top = std::max(top, z);
    return top;
  };
  EXPECT_GT(highest("500000 4000000 0"), 0.5);
  EXPECT_LT(highest("500000 4000000 -9"), 0.11);
}

TEST(Explosions, RandomOnesLieOnTheSurface) {
  const Coast coast;
  const Result result = blown(coast.site, {{"count", std::int64_t{6}}, {"depth", 0.0}, {"radius", 3.0}});
  EXPECT_EQ(fact<std::int64_t>(result, "explosions"), 6);
  const auto before = field::compile(coast.site.terrain), after = carved(coast.site, result);
  const auto positions = fact<Places>(result, "positions").local;
  ASSERT_EQ(positions.size(), 6u);
  for (const Vec3d& p : positions) {
    EXPECT_NEAR(before.value(p), 0, 0.05);
    EXPECT_LT(after.value(p), -1);
  }
}

TEST(Explosions, RefuseWhatIsWrong) {
  const Coast coast = meadow();
  const auto refused = [&](const Row& row) {
    return error_of([&] { blown(coast.site, {{"blast", Rows{row}}}); });
  };
  for (const char* at : {"1 2", "1 2 3 4", "here"})
    EXPECT_THAT(refused({{"at", at}}), testing::HasSubstr("blast, row 1: at must be")) << at;
  EXPECT_THAT(refused({{"at", ""}}), testing::HasSubstr("blast, row 1: it needs at, three numbers x y z"));
  EXPECT_THAT(refused({{"at", "1 2 3"}, {"radius", "0"}}),
              testing::HasSubstr("radius = 0 is outside 0.1 to 500 m"));
}

}  // namespace
}  // namespace tafoni::landforms::test
