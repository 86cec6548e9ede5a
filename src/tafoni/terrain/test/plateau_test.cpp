#include <algorithm>

#include <gtest/gtest.h>

#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::terrain {
namespace {

/// 5.2 km at 10 m.
raster::Raster plateau(std::uint64_t seed, Values values = {}) {
  values.insert({{"width", std::int64_t{520}}, {"height", std::int64_t{520}}, {"pixel", 10.0}});
  return find_generator("plateau").generate(values, seed, silent());
}

std::ptrdiff_t dolines(const raster::Raster& heights) {
  const auto found = sinks(heights, {.min_depth = 9});
  return std::count_if(found.begin(), found.end(), [](const Sink& s) { return s.elevation > 420; });
}

class PlateauSeeds : public testing::TestWithParam<std::uint64_t> {};

TEST_P(PlateauSeeds, HasACliffAllAlong) {
  const auto made = plateau(GetParam());
  int columns = 0;
  for (int col = 0; col < made.width(); ++col) {
    float drop = 0;
    for (int row = 0; row + 12 < made.height(); ++row)
      drop = std::max(drop, made.values.at(col, row) - made.values.at(col, row + 12));
    columns += drop > 100;
  }
  EXPECT_GT(columns, 0.9 * made.width()) << "no 100 m within 120 m";
}

TEST_P(PlateauSeeds, HoldsManyDolinesAboveADrainedValley) {
  const auto made = plateau(GetParam());
  EXPECT_GT(dolines(made), 30);
  raster::Raster filled = made;
  filled.values = fill_depressions(made);
  const auto area = drainage_area(filled);
  // The valley leaves the map in the east.
  float most = 0;
  for (int row = 0; row < made.height(); ++row) most = std::max(most, area.at(made.width() - 1, row));
  EXPECT_GT(most, 3e6f);
  for (int row = 0; row < made.height(); ++row)
    for (int col = 0; col < made.width(); ++col)
      if (made.values.at(col, row) < 330) {
        ASSERT_LT(filled.values.at(col, row) - made.values.at(col, row), 12) << "a lake in the valley";
      }
}

INSTANTIATE_TEST_SUITE_P(Some, PlateauSeeds, testing::Values(1, 2, 3, 7, 42));

TEST(Plateau, ParametersDoWhatTheySay) {
  EXPECT_LT(2 * dolines(plateau(1, {{"dolines", 2.0}})), dolines(plateau(1)));
  const auto highest = [](const raster::Raster& r) {
    return *std::max_element(r.values.values().begin(), r.values.values().end());
  };
  EXPECT_GT(highest(plateau(1, {{"cliff", 500.0}})), 750);
  EXPECT_LT(highest(plateau(1, {{"cliff", 60.0}})), 480);
}

}  // namespace
}  // namespace tafoni::terrain
