#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/test/surfaces.h"

namespace tafoni::terrain {
namespace {

TEST(Sinks, AnInclinedPlaneHasNone) {
  EXPECT_TRUE(sinks(surface(20, 20, 1, 1, [](double x, double y) { return x + 2 * y; })).empty());
}

TEST(Sinks, AFlatHasNone) {
  EXPECT_TRUE(sinks(surface(20, 20, 1, 1, [](double, double) { return 7.0; })).empty());
}

TEST(Sinks, MeasuresAPyramidPit) {
  // Square rings of depth 0, 1, 2, 3 on 2 x 3 m pixels.
  const auto pit = surface(7, 7, 2, 3, [](double x, double y) {
    return 50 + std::max(std::abs(std::floor(x / 2) - 3), std::abs(std::floor(y / 3) - 3));
  });
  const auto found = sinks(pit);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].col, 3);
  EXPECT_EQ(found[0].row, 3);
  EXPECT_EQ(found[0].elevation, 50);
  EXPECT_EQ(found[0].spill, 53);
  EXPECT_EQ(found[0].depth(), 3);
  EXPECT_EQ(found[0].area, 25 * 6);
  EXPECT_EQ(found[0].volume, (3 + 8 * 2 + 16 * 1) * 6);
}

TEST(Sinks, TwoBasinsInOneDepressionAreOneSink) {
  const auto two = surface(40, 20, 1, 1, [](double x, double y) {
    const double a = std::hypot(x - 12.5, y - 10.5), b = std::hypot(x - 22.5, y - 10.5) - 0.5;
    return std::min(a, b);
  });
  // The ridge between them is lower than the way out.
  const auto found = sinks(two);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].col, 22);
  EXPECT_EQ(found[0].row, 9);
}

TEST(Sinks, AreOrderedAndFiltered) {
  const auto dimples = surface(60, 60, 1, 1, [](double x, double y) {
    double h = 0.01 * x;
    for (const auto& [cx, cy, depth] : {std::array{15.5, 45.5, 4.0}, {45.5, 45.5, 2.0}, {30.5, 15.5, 1.0}})
      h -= depth * std::max(0.0, 1 - std::hypot(x - cx, y - cy) / 6);
    return h;
  });
  const auto all = sinks(dimples);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].col, 15);
  EXPECT_EQ(all[0].row, 14);
  EXPECT_EQ(all[1].col, 45);
  EXPECT_EQ(all[2].row, 44);
  const auto deep = sinks(dimples, {.min_depth = 1.5});
  ASSERT_EQ(deep.size(), 2u);
  EXPECT_EQ(deep[1].col, 45);
  EXPECT_EQ(sinks(dimples, {.min_area = 1e6}).size(), 0u);
}

TEST(Sinks, AddUpToTheFilledVolume) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto terrain = rough(40, 40, seed, seed % 2 ? 6 : 0, 0.01);
    const auto level = fill_depressions(terrain, {.drain_flats = false});
    double volume = 0, area = 0;
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (!(level.data()[i] > terrain.values.data()[i])) continue;
      volume += level.data()[i] - double{terrain.values.data()[i]};
      area += 1;
    }
    for (const Sink& sink : sinks(terrain)) {
      volume -= sink.volume;
      area -= sink.area;
      EXPECT_EQ(terrain.at(sink.col, sink.row), sink.elevation);
      EXPECT_EQ(level.at(sink.col, sink.row), sink.spill);
      EXPECT_GT(sink.depth(), 0);
      EXPECT_LE(sink.volume, sink.depth() * sink.area + 1e-9);
    }
    EXPECT_NEAR(volume, 0, 1e-6);
    EXPECT_EQ(area, 0);
  }
}

}  // namespace
}  // namespace tafoni::terrain
