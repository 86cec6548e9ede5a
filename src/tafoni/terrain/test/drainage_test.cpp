#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/stencil.h"
#include "tafoni/terrain/test/surfaces.h"

namespace tafoni::terrain {
namespace {

raster::Raster filled(raster::Raster terrain) {
  terrain.values = fill_depressions(terrain);
  return terrain;
}

/// The rule of [Freeman91] over cells sorted from high to low.
std::vector<double> brute_area(const raster::Raster& terrain, double exponent) {
  const auto& h = terrain.values;
  std::vector<std::size_t> order(h.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return std::isnan(h.data()[i]); });
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t k) { return h.data()[i] > h.data()[k]; });
  std::vector<double> area(h.size(), terrain.placement.dx * terrain.placement.dy);
  for (std::size_t i : order) {
    const auto [col, row] = impl::cell_of(h, i);
    std::vector<std::pair<std::size_t, double>> shares;
    double total = 0;
    for (int k = 0; k < 8; ++k) {
      const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
      if (!h.inside(c, r) || !(h.at(c, r) < h.at(col, row))) continue;
      const double d = std::hypot(impl::neighbour_col[k] * terrain.placement.dx,
                                  impl::neighbour_row[k] * terrain.placement.dy);
      const double share = std::pow((terrain.at(col, row) - terrain.at(c, r)) / d, exponent);
      shares.emplace_back(h.index(c, r), share);
      total += share;
    }
    for (const auto& [to, share] : shares) area[to] += area[i] * share / total;
  }
  return area;
}

TEST(Drainage, AgreesWithBruteForce) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    auto terrain = filled(rough(40, 30, seed, seed % 2 ? 4 : 0, seed > 5 ? 0.02 : 0));
    terrain.placement.dx = 2;
    const auto area = drainage_area(terrain);
    const auto expected = brute_area(terrain, 1.1);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (std::isnan(terrain.values.data()[i]))
        ASSERT_TRUE(std::isnan(area.data()[i]));
      else
        ASSERT_NEAR(area.data()[i], expected[i], 1e-5 * expected[i]) << seed << " " << i;
    }
  }
}

TEST(Drainage, OnAnInclinedPlaneEveryColumnOfCellsDrainsItself) {
  const auto plane = surface(40, 30, 2, 2, [](double x, double) { return x; });
  const auto area = drainage_area(plane);
  // Far from the north and south edges diagonal gains and losses are equal.
  for (int col = 30; col < 40; ++col) EXPECT_NEAR(area.at(col, 15), 4.0 * (40 - col), 1e-3);
}

TEST(Drainage, AllAreaArrivesAtTheOutlets) {
  const auto terrain = filled(rough(50, 50, 9, 5));
  const auto area = drainage_area(terrain);
  double out = 0;
  for (int row = 0; row < 50; ++row)
    for (int col = 0; col < 50; ++col) {
      bool lower = false;
      for (int k = 0; k < 8; ++k) {
        const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
        lower |= area.inside(c, r) && terrain.values.at(c, r) < terrain.values.at(col, row);
      }
      if (!lower) out += area.at(col, row);
    }
  EXPECT_NEAR(out, 2500, 0.01);
}

TEST(Drainage, ConeSpreadsAndPitCollects) {
  const auto pit = surface(41, 41, 1, 1, [](double x, double y) { return std::hypot(x - 20.5, y - 20.5); });
  const auto area = drainage_area(pit);
  EXPECT_NEAR(area.at(20, 20), 41 * 41, 0.01);
  const auto cone = surface(41, 41, 1, 1, [](double x, double y) { return -std::hypot(x - 20.5, y - 20.5); });
  const auto spread = drainage_area(cone);
  EXPECT_EQ(spread.at(20, 20), 1);
  EXPECT_NEAR(spread.at(25, 20), spread.at(15, 20), 1e-5);
  EXPECT_NEAR(spread.at(25, 20), spread.at(20, 25), 1e-5);
}

TEST(Drainage, DoesNotDependOnThreads) {
  const auto terrain = filled(rough(80, 70, 2));
  set_thread_count(1);
  const auto one = drainage_area(terrain);
  set_thread_count(2);
  const auto two = drainage_area(terrain);
  set_thread_count(0);
  EXPECT_EQ(one.values(), two.values());
}

TEST(Drainage, StreamPowerIsRootOfAreaTimesSlope) {
  raster::Grid<float> area(2, 1, 9), steep(2, 1, 0.5f);
  steep.at(1, 0) = raster::no_data;
  const auto power = stream_power(area, steep);
  EXPECT_FLOAT_EQ(power.at(0, 0), 1.5f);
  EXPECT_TRUE(std::isnan(power.at(1, 0)));
}

}  // namespace
}  // namespace tafoni::terrain
