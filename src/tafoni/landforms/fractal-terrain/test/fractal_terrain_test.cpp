#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/landforms/test/flood.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms::test {
namespace {

Result grown(const Site& site, const Values& values) {
  return find_landform("fractal-terrain").generate(site, values, silent());
}

double level(double, double) {
  return 0;
}
Coast flat() {
  return Coast([](Vec3d) { return 0.5; }, &level);
}
const Box3d about{{-45, -35, -25}, {45, 35, 25}};

TEST(FractalTerrain, IsTheTerrainWithoutNoise) {
  const Coast coast;
  const auto field = carved(coast.site, grown(coast.site, {{"noise", 0.0}, {"spacing", 0.5}}));
  for (Vec3d p : places({{-50, -40, 0}, {50, 40, 0}}, 500, 1)) {
    p.z = Coast::ground(p.x, p.y);
    if (std::abs(p.y) < 8) continue;  // the cliff, where a sample is worth more than a slope
    EXPECT_GT(field.value(p - Vec3d{0, 0, 0.4}), 0) << p.x << ' ' << p.y;
    EXPECT_LT(field.value(p + Vec3d{0, 0, 0.4}), 0) << p.x << ' ' << p.y;
  }
  const Coast plain = flat();
  for (bool detail : {true, false}) {
    const auto level_field = carved(plain.site, grown(plain.site, {{"noise", 0.0}, {"detail", detail}}));
    for (const Vec3d& p : places(about, 2000, 2)) {
      // In the cell where the limit begins the volume cuts its corner.
      if (std::abs(p.z) < 6.5) {
        ASSERT_NEAR(level_field.value(p), -p.z, 1e-4f);
      }
      if (std::abs(p.z) > 9) {
        ASSERT_EQ(level_field.value(p), p.z < 0 ? 7.5f : -7.5f);
      }
    }
  }
}

/// How often a vertical line enters rock more than once.
double overhangs(const Site& site, double noise) {
  const auto field = carved(site, grown(site, {{"noise", noise}, {"coarse", 24.0}, {"spacing", 1.0}}));
  double more = 0;
  constexpr int lines = 400, steps = 200;
  for (const Vec3d& at : places({{-45, -35, 0}, {45, 35, 0}}, lines, 3)) {
    std::vector<Vec3d> line;
    for (int k = 0; k < steps; ++k) line.push_back({at.x, at.y, -50 + 0.5 * k});
    const auto f = values(field, line);
    int enters = 0;
    for (int k = 1; k < steps; ++k) enters += f[k - 1] > 0 && f[k] <= 0;
    more += enters > 1;
  }
  return more / lines;
}

TEST(FractalTerrain, NoiseMakesHillsThenOverhangsThenCaves) {
  const Coast coast = flat();
  const double hills = overhangs(coast.site, 0.15), crags = overhangs(coast.site, 0.9),
               caves = overhangs(coast.site, 2.0);
  EXPECT_LT(hills, 0.01);
  EXPECT_GT(crags, 0.02);
  EXPECT_GT(caves, 2 * crags);
  // Closets: air that no way leads to, and rock that floats.
  const auto field =
      carved(coast.site, grown(coast.site, {{"noise", 2.0}, {"coarse", 24.0}, {"spacing", 1.0}}));
  std::size_t closed = 0;
  for (const Piece& air : pieces(field, {{-45, -35, -60}, {45, 35, 60}}, 1, false))
    closed += !air.at_rim && air.cells > 5;
  EXPECT_GT(closed, 0u);
}

TEST(FractalTerrain, CoarseShapeAloneKeepsMountains) {
  const Coast hill([](Vec3d) { return 0.5; },
                   [](double x, double y) { return 20 * std::exp(-(x * x + y * y) / 400); });
  const auto field =
      carved(hill.site, grown(hill.site, {{"noise", 0.0}, {"detail", false}, {"coarse", 12.0}}));
  EXPECT_GT(field.value({0, 0, 14}), 0);
  EXPECT_LT(field.value({0, 0, 22}), 0);
  EXPECT_LT(field.value({50, 30, 3}), 0);
}

TEST(FractalTerrain, ARegionKeepsWhatLiesOutside) {
  Coast coast;
  Region region;
  region.limit_box({{-20, -30, -100}, {30, 25, 100}});
  coast.site.region = &region;
  const Result result = grown(coast.site, {{"noise", 0.8}});
  const auto before = field::compile(coast.site.terrain), after = carved(coast.site, result);
  int changed = 0;
  for (const Vec3d& p : places({{-58, -44, -20}, {58, 44, 50}}, 20000, 4)) {
    const float a = before.value(p), b = after.value(p);
    if (!region.contains(p) || !result.reshaped.contains(p))
      ASSERT_EQ(a, b);
    else
      changed += a != b;
  }
  EXPECT_GT(changed, 1000);
}

TEST(FractalTerrain, PinsRaiseMountainsAndOpenHollows) {
  const Coast coast = flat();
  const Row hill = {{"x", "500020"}, {"y", "4000010"}, {"z", "15"}, {"value", "4"}, {"radius", "25"}};
  const Row hollow = {{"x", "499970"}, {"y", "3999990"}, {"z", "-10"}, {"value", "-3"}, {"radius", "12"}};
  const auto field = carved(coast.site, grown(coast.site, {{"noise", 0.2}, {"pin", Rows{hill, hollow}}}));
  EXPECT_GT(field.value({20, 10, 15}), 0);
  EXPECT_LT(field.value({-30, -10, -10}), 0);
  const auto refused = [&](const Row& row) {
    return error_of([&] { grown(coast.site, {{"pin", Rows{row}}}); });
  };
  EXPECT_THAT(refused({{"x", "here"}, {"y", "0"}}), testing::HasSubstr("pin, row 1: x must be"));
  EXPECT_THAT(refused({{"y", "0"}}), testing::HasSubstr("pin, row 1: it needs a number for x"));
}

TEST(FractalTerrain, SameSeedSameBitsOnAnyThreads) {
  Coast coast;
  const auto bits = [&](int threads) {
    set_thread_count(threads);
    const auto f = values(carved(coast.site, grown(coast.site, {{"noise", 1.0}, {"spacing", 1.0}})),
                          places(about, 3000, 5));
    set_thread_count(0);
    return f;
  };
  const auto one = bits(1);
  EXPECT_EQ(bits(3), one);
  coast.site.seed = 6;
  EXPECT_NE(bits(1), one);
}

}  // namespace
}  // namespace tafoni::landforms::test
