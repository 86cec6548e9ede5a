#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/math/counts.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::terrain {
namespace {

raster::Raster badlands(std::uint64_t seed, Values values = {}) {
  values.emplace("width", std::int64_t{300});
  values.emplace("height", std::int64_t{300});
  values.emplace("pixel", 1.0);
  return find_generator("badlands").generate(values, seed, silent());
}

double share(const raster::Grid<float>& grid, float lo, float hi) {
  const auto n =
      std::count_if(grid.values().begin(), grid.values().end(), [&](float v) { return v >= lo && v < hi; });
  return ratio(n, grid.size());
}

/// Sharp crests along some rows of the bowl.
int crests(const raster::Raster& made) {
  int n = 0;
  for (int row = 60; row < 260; row += 10)
    for (int col = 3; col + 3 < made.width(); ++col) {
      const auto h = [&](int d) { return made.values.at(col + d, row); };
      n += h(0) > h(-3) + 1.5f && h(0) > h(3) + 1.5f && h(0) > h(-1) && h(0) >= h(1);
    }
  return n;
}

class BadlandsSeeds : public testing::TestWithParam<std::uint64_t> {};

TEST_P(BadlandsSeeds, HaveAPlateauWallsAndAFloor) {
  const auto made = badlands(GetParam());
  const auto [lo, hi] = std::minmax_element(made.values.values().begin(), made.values.values().end());
  EXPECT_NEAR(*hi - *lo, 60, 15);
  // The plateau's north is level, the middle is not.
  const auto steep = slope(made);
  EXPECT_GT(share(steep, 0.7f, 1e9f), 0.1);
  EXPECT_LT(share(steep, 0.7f, 1e9f), 0.6);
  EXPECT_GT(share(steep, 0, 0.3f), 0.2);
}

TEST_P(BadlandsSeeds, DrainToTheSouth) {
  const auto made = badlands(GetParam());
  raster::Raster filled = made;
  filled.values = fill_depressions(made);
  int deep = 0;
  for (std::size_t i = 0; i < made.values.size(); ++i)
    deep += filled.values.data()[i] - made.values.data()[i] > 1.5f;
  EXPECT_LT(deep, 0.02 * made.width() * made.height());
  const auto area = drainage_area(filled);
  const auto most = std::max_element(area.values().begin(), area.values().end()) - area.values().begin();
  EXPECT_GT(most / made.width(), made.height() - 12);
  EXPECT_GT(*std::max_element(area.values().begin(), area.values().end()), 0.15 * 300 * 300);
}

TEST_P(BadlandsSeeds, HaveFinsOfTheWidthThatIsAsked) {
  const int narrow = crests(badlands(GetParam(), {{"fins", 14.0}}));
  const int wide = crests(badlands(GetParam(), {{"fins", 45.0}}));
  EXPECT_GT(narrow, 1.4 * wide);
  EXPECT_GT(wide, 10);
}

INSTANTIATE_TEST_SUITE_P(Some, BadlandsSeeds, testing::Values(1, 2, 7));

TEST(Badlands, WaterMakesTheGullies) {
  EXPECT_GT(crests(badlands(1)), 2 * crests(badlands(1, {{"incision", 0.0}})));
}

}  // namespace
}  // namespace tafoni::terrain
