#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/terrain/generator.h"

namespace tafoni::terrain {
namespace {

raster::Raster cliff(Values values = {}) {
  return find_generator("cliff").generate(values, 3, silent());
}

TEST(Cliff, FallsFromThePlateauToTheShelf) {
  const auto made = cliff();
  for (int row = 0; row < made.height(); ++row) {
    EXPECT_NEAR(made.values.at(0, row), 60, 2);
    EXPECT_NEAR(made.values.at(made.width() - 1, row), 2, 1.5);
    float drop = 0;
    for (int col = 0; col + 40 < made.width(); ++col)
      drop = std::max(drop, made.values.at(col, row) - made.values.at(col + 40, row));
    EXPECT_GT(drop, 45) << "no face within 20 m";
  }
}

TEST(Cliff, WithoutBendsAndReliefTheFaceIsAPlaneAtItsPlace) {
  const auto made = cliff({{"bends", 0.0}, {"roughness", 0.0}, {"place", 0.5}, {"slope", 45.0}});
  for (int row : {0, 90}) {
    // Half way down in the middle, and one metre down a metre.
    EXPECT_NEAR(0.5f * (made.values.at(139, row) + made.values.at(140, row)), 31, 0.01);
    EXPECT_NEAR(made.values.at(120, row) - made.values.at(160, row), 20, 0.01);
  }
}

TEST(Cliff, MayRiseEastward) {
  const auto made = cliff({{"elevation", 0.0}, {"shelf", 50.0}});
  EXPECT_NEAR(made.values.at(0, 50), 0, 2);
  EXPECT_NEAR(made.values.at(made.width() - 1, 50), 50, 2);
}

}  // namespace
}  // namespace tafoni::terrain
