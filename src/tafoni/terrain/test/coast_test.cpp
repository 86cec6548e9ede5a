#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/math/counts.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain {
namespace {

raster::Raster coast(std::uint64_t seed, const Values& values = {}) {
  return find_generator("coast").generate(values, seed, silent());
}

double share(const std::vector<float>& values, float least) {
  const auto n = std::count_if(values.begin(), values.end(), [&](float v) { return v > least; });
  return ratio(n, values.size());
}

/// Pieces of land above a height, by their sizes in cells.
std::vector<int> pieces(const raster::Grid<float>& heights, float above) {
  std::vector<int> sizes;
  std::vector<bool> seen(heights.size(), false);
  std::vector<std::pair<int, int>> stack;
  const auto visit = [&](int col, int row) {
    if (!heights.inside(col, row) || seen[heights.index(col, row)] || !(heights.at(col, row) > above)) return;
    seen[heights.index(col, row)] = true;
    stack.emplace_back(col, row);
    ++sizes.back();
  };
  for (int row = 0; row < heights.height(); ++row)
    for (int col = 0; col < heights.width(); ++col) {
      sizes.push_back(0);
      visit(col, row);
      while (!stack.empty()) {
        const auto [c, r] = stack.back();
        stack.pop_back();
        for (int k = 0; k < 8; ++k) visit(c + impl::neighbour_col[k], r + impl::neighbour_row[k]);
      }
      if (sizes.back() == 0) sizes.pop_back();
    }
  return sizes;
}

class CoastSeeds : public testing::TestWithParam<std::uint64_t> {};

TEST_P(CoastSeeds, HasSeaCliffsStacksAndDolines) {
  const auto made = coast(GetParam());
  EXPECT_EQ(made.width(), 600);
  EXPECT_EQ(made.height(), 450);
  const auto& h = made.values.values();
  EXPECT_NEAR(1 - share(h, 0), 0.34, 0.06);
  const auto [lowest, highest] = std::minmax_element(h.begin(), h.end());
  EXPECT_LT(*lowest, -4);
  EXPECT_GT(*highest, 50);
  EXPECT_LT(*highest, 110);
  const double cliffs = share(slope(made).values(), 2.0f);
  EXPECT_GT(cliffs, 0.03) << "too little steeper than 63 degrees";
  EXPECT_LT(cliffs, 0.12);
  const auto land = pieces(made.values, 1.0f);
  const auto stacks = std::count_if(land.begin(), land.end(), [](int n) { return n >= 12 && n < 3000; });
  EXPECT_GE(stacks, 3);
  EXPECT_GT(*std::max_element(land.begin(), land.end()), 100000);
  const auto holes = sinks(made, {.min_depth = 1.5});
  EXPECT_GE(std::count_if(holes.begin(), holes.end(), [](const Sink& s) { return s.elevation > 15; }), 8);
}

TEST_P(CoastSeeds, CliffsAreHighWithinAFewMetres) {
  const auto made = coast(GetParam());
  int high = 0;
  for (int row = 0; row + 20 < 450; ++row)
    for (int col = 0; col < 600; ++col) {
      const float drop = made.values.at(col, row) - made.values.at(col, row + 20);
      high += drop > 30 && made.values.at(col, row + 20) < 5;
    }
  EXPECT_GT(high, 1500) << "hardly any face rises by 30 m over 20 m";
}

INSTANTIATE_TEST_SUITE_P(Some, CoastSeeds, testing::Values(1, 2, 3, 7, 42));

TEST(Coast, ParametersDoWhatTheySay) {
  EXPECT_NEAR(1 - share(coast(1, {{"sea", 0.7}}).values.values(), 0), 0.7, 0.06);
  const auto low = coast(1, {{"cliff", 12.0}}), high = coast(1, {{"cliff", 90.0}});
  EXPECT_LT(*std::max_element(low.values.values().begin(), low.values.values().end()), 45);
  EXPECT_GT(*std::max_element(high.values.values().begin(), high.values.values().end()), 95);
  const auto dry = [](const std::vector<Sink>& found) {
    return std::count_if(found.begin(), found.end(), [](const Sink& s) { return s.elevation > 15; });
  };
  // Hollows of the plateau and the shore remain.
  EXPECT_LT(dry(sinks(coast(1, {{"dolines", 0.0}}), {.min_depth = 1.5})) + 10,
            dry(sinks(coast(1), {.min_depth = 1.5})));
  EXPECT_LT(pieces(coast(1, {{"stacks", 0.0}}).values, 1.0f).size(), pieces(coast(1).values, 1.0f).size());
}

}  // namespace
}  // namespace tafoni::terrain
