#include <algorithm>

#include <gtest/gtest.h>

#include "tafoni/math/counts.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::terrain {
namespace {

/// 1.1 km at 2 m.
raster::Raster canyon(std::uint64_t seed, Values values = {}) {
  values.insert({{"width", std::int64_t{550}}, {"height", std::int64_t{550}}, {"pixel", 2.0}});
  return find_generator("canyon").generate(values, seed, silent());
}

double share_steeper(const raster::Raster& heights, float than) {
  const auto steep = slope(heights);
  const auto n =
      std::count_if(steep.values().begin(), steep.values().end(), [than](float s) { return s > than; });
  return ratio(n, steep.size());
}

class CanyonSeeds : public testing::TestWithParam<std::uint64_t> {};

TEST_P(CanyonSeeds, IsAMesaWithSteepWalls) {
  const auto made = canyon(GetParam());
  const auto [lowest, highest] =
      std::minmax_element(made.values.values().begin(), made.values.values().end());
  EXPECT_NEAR(*lowest, 1300, 3) << "the river at the southern edge";
  EXPECT_GT(*highest, 1540);
  EXPECT_LT(*highest, 1640);
  const double mesa = ratio(std::count_if(made.values.values().begin(), made.values.values().end(),
                                          [](float h) { return h > 1480; }),
                            made.values.size());
  EXPECT_GT(mesa, 0.4);
  EXPECT_LT(mesa, 0.9);
  EXPECT_GT(share_steeper(made, 1.7f), 0.1);
  EXPECT_LT(share_steeper(made, 1.7f), 0.5);
}

TEST_P(CanyonSeeds, DrainsByItsRiver) {
  const auto made = canyon(GetParam());
  raster::Raster filled = made;
  filled.values = fill_depressions(made);
  const auto area = drainage_area(filled);
  // Where the most water leaves the map is the lowest place of its southern edge.
  int outlet = 0, lowest = 0;
  for (int col = 0; col < made.width(); ++col) {
    if (area.at(col, made.height() - 1) > area.at(outlet, made.height() - 1)) outlet = col;
    if (made.values.at(col, made.height() - 1) < made.values.at(lowest, made.height() - 1)) lowest = col;
  }
  EXPECT_NEAR(outlet, lowest, 6);
  EXPECT_GT(area.at(outlet, made.height() - 1), 0.25 * 1100 * 1100) << "most water runs somewhere else";
  // The river finds its way without deep lakes.
  int lakes = 0, river = 0;
  for (std::size_t i = 0; i < area.size(); ++i) {
    if (!(area.data()[i] > 40000)) continue;
    ++river;
    lakes += filled.values.data()[i] - made.values.data()[i] > 4;
  }
  EXPECT_GT(river, 600);
  EXPECT_LT(lakes, 0.1 * river);
}

INSTANTIATE_TEST_SUITE_P(Some, CanyonSeeds, testing::Values(1, 2, 3, 7, 42));

TEST(Canyon, ParametersDoWhatTheySay) {
  const auto highest = [](const raster::Raster& r) {
    return *std::max_element(r.values.values().begin(), r.values.values().end());
  };
  EXPECT_LT(highest(canyon(1, {{"relief", 80.0}})), 1440);
  EXPECT_LT(share_steeper(canyon(1, {{"sides", 0.0}}), 1.7f), 0.8 * share_steeper(canyon(1), 1.7f));
  const auto wide = canyon(1, {{"river", 200.0}}), narrow = canyon(1);
  const auto floor = [](const raster::Raster& r) {
    return std::count_if(r.values.values().begin(), r.values.values().end(),
                         [](float h) { return h < 1330; });
  };
  EXPECT_GT(floor(wide), 3 * floor(narrow));
}

}  // namespace
}  // namespace tafoni::terrain
