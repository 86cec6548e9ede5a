#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/landforms/canyon/streams.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/landforms/test/site.h"
#include "tafoni/math/counts.h"
#include "tafoni/raster/sampled.h"

namespace tafoni::landforms {
namespace {

double middle(double y) {
  return 14 * std::sin(y / 17);
}
double bed(double y) {
  return 0.05 * (y + 80);
}

/// A winding valley with sides of 45 degrees that drains to the south.
struct Valley {
  explicit Valley(
      std::function<double(Vec3d)> rho = [](Vec3d) { return 0.3; },
      const std::function<double(double, double)>& elevation =
          [](double x, double y) { return bed(y) + std::abs(x - middle(y)); }) {
    const auto raster =
        std::make_shared<raster::Raster>(raster::sampled(140, 160, {-70, 80, 1, 1}, elevation));
    site.origin = {300000, 5000000, 100};
    site.heights = raster;
    site.terrain = field::heightfield(raster, {});
    site.geology = std::make_shared<const test::Rock>(std::move(rho));
    site.seed = 3;
  }

  Result run(const Values& values = {}) const {
    return find_landform("canyon").generate(site, values, silent());
  }
  Site site;
};

constexpr Box3d inner{{-65, -70, -5}, {65, 70, 60}};

/// Which of many places in the valley were rock and are no more.
std::vector<Vec3d> carved_away(const Valley& valley, const Values& values = {}) {
  const auto points = test::places(inner, 200000, 5);
  const auto before = test::values(field::compile(valley.site.terrain), points);
  const auto after = test::values(test::carved(valley.site, valley.run(values)), points);
  std::vector<Vec3d> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (before[i] > 0 && after[i] <= 0) out.push_back(points[i]);
  return out;
}

template <class Which>
std::ptrdiff_t count(const std::vector<Vec3d>& points, const Which& which) {
  return std::count_if(points.begin(), points.end(), which);
}

TEST(Canyon, SofterRockIsCarvedMore) {
  std::vector<std::size_t> carved;
  for (const double rho : {0.05, 0.5, 0.95})
    carved.push_back(carved_away(Valley([rho](Vec3d) { return rho; })).size());
  EXPECT_GT(carved[2], 50u) << "the hardest rock gives way by beta";
  EXPECT_GT(ratio(carved[1], carved[2]), 1.3);
  EXPECT_GT(ratio(carved[0], carved[1]), 1.3);
}

TEST(Canyon, SoftBedsRecede) {
  const auto soft = [](Vec3d p) { return std::fmod(p.z + 60, 8) < 4; };
  const auto carved = carved_away(Valley([&](Vec3d p) { return soft(p) ? 0.05 : 0.95; }));
  const auto in_soft = count(carved, soft);
  EXPECT_GT(ratio(in_soft, std::ssize(carved) - in_soft), 1.8);
}

TEST(Canyon, CarvesMoreWhereMoreWaterRuns) {
  const auto carved = carved_away(Valley());
  const auto downstream = count(carved, [](Vec3d p) { return p.y < -35; });
  const auto upstream = count(carved, [](Vec3d p) { return p.y > 35; });
  EXPECT_GT(ratio(downstream, upstream), 1.2);
}

/// Where the river swings to the east, the outer bank is the eastern one.
double outer_to_inner(double undercut) {
  const auto carved = carved_away(Valley(), {{"undercut", undercut}});
  const auto bend = [](Vec3d p) { return std::abs(middle(p.y)) > 9; };
  const auto side = [](Vec3d p) { return (p.x - middle(p.y)) * middle(p.y); };
  const auto outer = count(carved, [&](Vec3d p) { return bend(p) && side(p) > 0; });
  const auto inner_bank = count(carved, [&](Vec3d p) { return bend(p) && side(p) < 0; });
  return ratio(outer, inner_bank);
}

TEST(Canyon, UndercutsOuterBends) {
  EXPECT_GT(outer_to_inner(0.85), 1.1);
  EXPECT_GT(outer_to_inner(0.85), 1.4 * outer_to_inner(0));
}

TEST(Canyon, KeepsToTheRiverAndItsBanks) {
  const Valley valley;
  const Values values{{"radius", 2.0}, {"banks", 8.0}, {"height", 12.0}, {"flood", 1.0}, {"retreat", 6.0}};
  const auto before = field::compile(valley.site.terrain),
             after = test::carved(valley.site, valley.run(values));
  for (const Vec3d p : test::places(inner, 60000, 6)) {
    // A bank's own elevation is a local mean, and rows lead 6 m into the rock.
    if (p.z > bed(p.y) + 12 + 6 || std::abs(p.x - middle(p.y)) > 8 + 3 + 14) {
      ASSERT_EQ(before.value(p), after.value(p)) << p.x << ' ' << p.y << ' ' << p.z;
    }
  }
}

double overhanging(const field::CompiledField& field) {
  SurfaceSampling sampling;
  sampling.spacing = 1.5;
  sampling.box = inner;
  sampling.accept = [](const SurfaceSample& p) {
    return std::abs(p.position.x - middle(p.position.y)) < 20 && p.position.z < bed(p.position.y) + 20;
  };
  const auto points = sample_surface(field, sampling);
  const auto n =
      std::count_if(points.begin(), points.end(), [](const SurfaceSample& p) { return p.normal.z < 0; });
  return ratio(n, points.size());
}

TEST(Canyon, WallsOverhang) {
  const Valley valley;
  EXPECT_EQ(overhanging(field::compile(valley.site.terrain)), 0);
  EXPECT_GT(overhanging(test::carved(valley.site, valley.run())), 0.04);
}

TEST(Canyon, WithoutARiverThereIsNothing) {
  const auto hard = [](Vec3d) { return 0.1; };
  for (const auto& dry : std::vector<std::function<double(double, double)>>{
           [](double, double y) { return 0.3 * y; },
           [](double x, double y) { return 0.2 * y + 0.15 * x; },
           [](double x, double y) { return 60 - 0.5 * std::hypot(x, y); },
       }) {
    SCOPED_TRACE(dry(10, 1));
    const Result result = Valley(hard, dry).run();
    EXPECT_TRUE(result.nodes.empty());
    EXPECT_EQ(test::fact<double>(result, "river_bed"), 0);
  }
}

TEST(Canyon, ASlotIsDeepNarrowAndLeansOver) {
  const Valley valley;
  const double depth = 16, width = 3;
  const Values values{{"slot_depth", depth}, {"slot_width", width}, {"retreat", 0.01}, {"winding", 1.0}};
  const Result result = valley.run(values);
  EXPECT_GT(test::fact<double>(result, "slot_length"), 100);
  const auto after = test::carved(valley.site, result);
  int open = 0, sections = 0, wide = 0, below = 0, leaning = 0;
  for (double y = -60; y < 30; y += 1.5, ++sections) {
    const auto span = [&](double under) {
      double lo = 1e9, hi = -1e9, air = 0;
      for (double x = middle(y) - 15; x < middle(y) + 15; x += 0.25)
        if (after.value({x, y, bed(y) - under}) < 0) {
          lo = std::min(lo, x);
          hi = std::max(hi, x);
          air += 0.25;
        }
      return std::array{lo, hi, air};
    };
    const auto high = span(0.4 * depth), low = span(0.65 * depth);
    open += high[2] > 0.8 && low[2] > 0.8;
    wide += high[2] > 3.5 * width;
    below += span(1.6 * depth)[2] > 0;
    leaning += std::abs(high[0] + high[1] - low[0] - low[1]) > 2 * 0.5;
  }
  EXPECT_GT(open, 0.85 * sections);
  EXPECT_LT(wide, 0.1 * sections);
  EXPECT_EQ(below, 0);
  EXPECT_GT(leaning, 0.25 * sections) << "the axis moves by half a metre and more from level to level";
}

TEST(Streams, TheMainStemIsTheValleyAndNothingRunsOffItsBanks) {
  const Valley valley;
  const impl::Ground ground(valley.site);
  const impl::Streams streams(ground, {0.05, 900, 1.5, 9}, silent());
  const auto courses = streams.courses(1);
  ASSERT_EQ(courses.size(), 1u);
  EXPECT_LT(courses[0].line.front().y, -74);
  EXPECT_GT(courses[0].line.back().y, 40);
  double last = -1e9;
  for (const Vec3d p : courses[0].line) {
    EXPECT_NEAR(p.x, middle(p.y), 2.5);
    EXPECT_GE(p.z, last) << "upstream it only rises";
    last = p.z;
  }
  EXPECT_GT(streams.at({middle(0), 0, 0}).stress, 0.1);
  EXPECT_EQ(streams.at({middle(0) + 30, 0, 0}).stress, 0);
  EXPECT_FALSE(streams.near({60, 0, 0}, 5, 20));
  EXPECT_TRUE(streams.near({middle(0) + 5, 0, 15}, 5, 20));
  EXPECT_FALSE(streams.near({middle(0) + 5, 0, 40}, 5, 20));
  EXPECT_LT(streams.at({middle(0), 0, 0}).flow.y, -0.5) << "water runs south";
}

}  // namespace
}  // namespace tafoni::landforms
