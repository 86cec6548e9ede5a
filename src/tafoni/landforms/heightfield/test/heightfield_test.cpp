#include <gtest/gtest.h>

#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

/// Level ground with the landform on it; the second terrain is level too, as its heights are scaled to
/// nothing.
struct Made {
  explicit Made(Values values) : coast([](Vec3d) { return 0.5; }, [](double, double) { return 10.0; }) {
    coast.site.influence = 6;
    values["scale"] = 0.0;
    result = find_landform("heightfield").generate(coast.site, values, silent());
  }
  float at(double x, double y, double z) const { return test::carved(coast.site, result).value({x, y, z}); }

  Coast coast;
  Result result;
};

TEST(Heightfield, AUnionAddsRockWithinItsOutlineOnly) {
  const Made made({{"elevation", 20.0}});
  EXPECT_GT(made.at(0, 0, 29), 0);
  EXPECT_LT(made.at(0, 0, 31), 0);
  EXPECT_LT(made.at(56, 0, 20), 0) << "R within the border";
}

TEST(Heightfield, AnInvertedOneHangsAbove) {
  const Made made({{"elevation", 20.0}, {"inverted", true}, {"thickness", 12.0}});
  EXPECT_LT(made.at(0, 0, 28), 0);
  EXPECT_GT(made.at(0, 0, 36), 0);
  EXPECT_LT(made.at(0, 0, 43), 0);
  EXPECT_GT(made.at(0, 0, 9), 0);
}

TEST(Heightfield, CutsOffWhatIsOutsideIt) {
  const Made lowered({{"elevation", -5.0}, {"operation", "intersection"}});
  EXPECT_LT(lowered.at(0, 0, 7), 0);
  EXPECT_GT(lowered.at(0, 0, 3), 0);
  EXPECT_GT(lowered.at(57, 0, 9), 0);
  const Made undermined({{"elevation", -5.0}, {"operation", "intersection"}, {"inverted", true}});
  EXPECT_GT(undermined.at(0, 0, 8), 0);
  EXPECT_LT(undermined.at(0, 0, 3), 0);
}

TEST(Heightfield, IsCutOut) {
  const Made made({{"elevation", -5.0}, {"operation", "difference"}});
  EXPECT_GT(made.at(0, 0, 8), 0);
  EXPECT_LT(made.at(0, 0, 3), 0);
}

TEST(Heightfield, KeepsWithinAPolygonWithAHole) {
  Coast coast([](Vec3d) { return 0.5; }, [](double, double) { return 10.0; });
  coast.site.influence = 3;
  Region region;
  region.limit_polygon(
      {{{-50, -40}, {50, -40}, {50, 40}, {-50, 40}}, {{-15, -15}, {15, -15}, {15, 15}, {-15, 15}}});
  coast.site.region = &region;
  const Result result =
      find_landform("heightfield").generate(coast.site, {{"scale", 0.0}, {"elevation", 20.0}}, silent());
  const auto field = test::carved(coast.site, result);
  EXPECT_LT(field.value({0, 0, 20}), 0) << "the hole";
  EXPECT_GT(field.value({30, 0, 20}), 0);
  EXPECT_LT(field.value({54, 0, 20}), 0);
}

}  // namespace
}  // namespace tafoni::landforms
