// What every landform must keep to, asked of each in the registry.

#include "tafoni/landforms/landform.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

/// A coast cut by a ravine with a stream: something for every landform to act on.
struct StreamCoast : test::Coast {
  StreamCoast() : test::Coast([](Vec3d) { return 0.3; }, &elevation) {}
  static double elevation(double x, double y) {
    const double bed = std::max(0.5, 1.5 + 0.12 * y), off = std::abs(x - 24 - 4 * std::sin(y / 12));
    return std::min(ground(x, y), y > -4 ? bed + 1.6 * off : 1e9);
  }
};

class EveryLandform : public testing::TestWithParam<const LandformType*> {
 protected:
  Result run(const Site& site, Progress& progress = silent()) {
    return GetParam()->generate(site, {}, progress);
  }
  static constexpr Box3d around{{-60, -45, -15}, {60, 45, 45}};
};

TEST_P(EveryLandform, IsDocumented) {
  const LandformType& type = *GetParam();
  EXPECT_FALSE(type.about.doc.empty());
  EXPECT_FALSE(type.about.source.empty());
  ASSERT_TRUE(type.generate);
  EXPECT_EQ(&find_landform(type.about.name), &type);
  for (const ParamInfo& info : type.about.params) {
    EXPECT_FALSE(info.doc.empty()) << info.name;
    EXPECT_NE(info.doc.back(), '.') << info.name;
    EXPECT_NO_THROW(check_value(info, info.init, type.about.name))
        << info.name << " has a default out of its range";
    if (info.kind == ValueKind::real || info.kind == ValueKind::integer) {
      EXPECT_LT(info.min, info.max) << info.name;
    }
  }
}

TEST_P(EveryLandform, ChangesTheTerrainAndTellsHowManyPrimitivesItTook) {
  const StreamCoast coast;
  const Result result = run(coast.site);
  const auto points = test::places(around, 20000, 7);
  EXPECT_NE(test::values(field::compile(coast.site.terrain), points),
            test::values(test::carved(coast.site, result), points));
  std::int64_t primitives = 0;
  for (const auto& node : result.nodes) primitives += field::stats(node).primitives;
  EXPECT_EQ(test::fact<std::int64_t>(result, "primitives"), primitives);
}

TEST_P(EveryLandform, ExplainsWhatItTells) {
  const StreamCoast coast;
  for (const Fact& fact : run(coast.site).facts) {
    if (fact.name == "primitives") continue;
    EXPECT_FALSE(fact.about.empty()) << fact.name;
    EXPECT_FALSE(fact.about.ends_with('.')) << fact.name;
  }
}

TEST_P(EveryLandform, MovesNoSurfaceBelowItsLowest) {
  const StreamCoast coast;
  const Result result = run(coast.site);
  const double lowest = lowest_change(result);
  if (!std::isfinite(lowest)) return;
  const auto before = field::compile(coast.site.terrain);
  const auto after = test::carved(coast.site, result);
  Box3d below = around;
  below.hi.z = lowest;
  below.lo.z = std::min(below.lo.z, lowest - 20);
  for (const Vec3d p : test::places(below, 5000, 11))
    EXPECT_EQ(before.value(p) > 0, after.value(p) > 0) << p.x << ' ' << p.y << ' ' << p.z;
}

TEST_P(EveryLandform, ReshapesWhereItSays) {
  const StreamCoast coast;
  const Result result = run(coast.site);
  if (!result.reshape) return;
  ASSERT_FALSE(result.reshaped.empty());
  const auto before = field::compile(coast.site.terrain);
  const auto after = field::compile(result.reshape(coast.site.terrain));
  for (const Vec3d p : test::places(around.grown(60), 30000, 8)) {
    if (!result.reshaped.contains(p)) {
      ASSERT_EQ(before.value(p), after.value(p));
    }
  }
}

TEST_P(EveryLandform, SameSeedSameBytesWithAnyNumberOfThreads) {
  const StreamCoast coast;
  const auto points = test::places(around, 20000, 2);
  set_thread_count(1);
  const Result one = run(coast.site);
  const auto a = test::values(test::carved(coast.site, one), points);
  set_thread_count(2);
  const Result two = run(coast.site);
  const auto b = test::values(test::carved(coast.site, two), points);
  set_thread_count(0);
  EXPECT_EQ(a, b);
  EXPECT_EQ(one.facts, two.facts);
  StreamCoast other;
  other.site.seed = 6;
  EXPECT_NE(a, test::values(test::carved(other.site, run(other.site)), points));
}

TEST_P(EveryLandform, StaysInItsRegion) {
  StreamCoast coast;
  Region region;
  const Box3d box{{-25, -20, -10}, {36, 20, 24}};
  region.limit_box(box);
  coast.site.region = &region;
  const Result result = run(coast.site);
  const auto before = field::compile(coast.site.terrain), after = test::carved(coast.site, result);
  // No primitive's centre lies outside, and none reaches farther than this.
  const Box3d reached = box.grown(12);
  int changed = 0;
  for (const Vec3d p : test::places(around, 60000, 3)) {
    if (!reached.contains(p)) {
      ASSERT_EQ(before.value(p), after.value(p));
    }
    changed += before.value(p) != after.value(p);
  }
  EXPECT_GT(changed, 0);
}

TEST_P(EveryLandform, DoesNothingWhereItMayNotAct) {
  StreamCoast coast;
  Region region;
  region.limit_polygon({{}});
  coast.site.region = &region;
  const auto nothing = [&] {
    const Result result = run(coast.site);
    return result.nodes.empty() && !result.reshape;
  };
  EXPECT_TRUE(nothing());
  Region elsewhere;
  elsewhere.limit_box({{1e5, 1e5, 0}, {1e5 + 10, 1e5 + 10, 10}});
  coast.site.region = &elsewhere;
  EXPECT_TRUE(nothing());
}

TEST_P(EveryLandform, KeepsOffMissingData) {
  StreamCoast coast;
  raster::Grid<std::uint8_t> valid(StreamCoast::width, StreamCoast::height, 1);
  for (int row = 0; row < StreamCoast::height; ++row)
    for (int col = 0; col < 60; ++col) valid.at(col, row) = 0;
  coast.site.valid = &valid;
  const auto before = field::compile(coast.site.terrain), after = test::carved(coast.site, run(coast.site));
  for (const Vec3d p : test::places({{-60, -45, -15}, {-12, 45, 45}}, 20000, 4))
    ASSERT_EQ(before.value(p), after.value(p));
}

TEST_P(EveryLandform, CanBeCancelled) {
  const StreamCoast coast;
  Progress progress;
  progress.cancel();
  try {
    run(coast.site, progress);
    FAIL() << "went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cancelled);
  }
}

TEST_P(EveryLandform, WorksWithoutGeology) {
  StreamCoast coast;
  coast.site.geology = nullptr;
  EXPECT_NO_THROW(run(coast.site));
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryLandform,
                         testing::ValuesIn(all_landforms().begin(), all_landforms().end()),
                         [](const auto& test_case) {
                           std::string name = test_case.param->about.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(Landform, AnUnknownNameGetsTheNearestKnown) {
  try {
    find_landform("sea-clif");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), testing::HasSubstr("\"sea-cliff\""));
  }
  EXPECT_THAT(error_of([] { find_landform("zzzzzzzzzzzz"); }), testing::HasSubstr("zzzzzzzzzzzz"));
}

}  // namespace
}  // namespace tafoni::landforms
