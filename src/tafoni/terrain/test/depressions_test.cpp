#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/math/draw.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/radix_heap.h"
#include "tafoni/terrain/impl/stencil.h"
#include "tafoni/terrain/test/surfaces.h"

namespace tafoni::terrain {
namespace {

/// The lowest surface that drains, by lowering a flooded one until nothing changes [Planchon02].
raster::Grid<float> brute_fill(const raster::Raster& heights, bool drain_flats) {
  const auto& h = heights.values;
  const float deep = std::numeric_limits<float>::infinity();
  raster::Grid<float> w(h.width(), h.height(), deep);
  const auto over = [&](float level) {
    return drain_flats ? std::max(std::nextafter(level, deep), level + 1e-6f) : level;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (int row = 0; row < h.height(); ++row)
      for (int col = 0; col < h.width(); ++col) {
        const float here = h.at(col, row);
        if (std::isnan(here)) continue;
        float level = deep;
        for (int k = 0; k < 8; ++k) {
          const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
          if (!h.inside(c, r) || std::isnan(h.at(c, r)))
            level = here;
          else if (level > here)
            level = std::min(level, std::max(here, over(w.at(c, r))));
        }
        if (level < w.at(col, row)) {
          w.at(col, row) = level;
          changed = true;
        }
      }
  }
  for (std::size_t i = 0; i < w.size(); ++i)
    if (std::isnan(h.data()[i])) w.data()[i] = raster::no_data;
  return w;
}

void expect_same(const raster::Grid<float>& a, const raster::Grid<float>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_TRUE(a.data()[i] == b.data()[i] || (std::isnan(a.data()[i]) && std::isnan(b.data()[i])))
        << i << ": " << a.data()[i] << " and " << b.data()[i];
}

TEST(Depressions, AgreeWithBruteForce) {
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (int steps : {0, 3, 12})
      for (bool drain : {false, true}) {
        const auto terrain = rough(31, 24, seed, steps, seed % 3 == 0 ? 0.03 : 0);
        SCOPED_TRACE(testing::Message() << seed << " " << steps << " " << drain);
        expect_same(fill_depressions(terrain, {.drain_flats = drain}), brute_fill(terrain, drain));
      }
}

TEST(Depressions, DrainedSurfaceLeadsDownFromEveryCell) {
  const auto terrain = surface(60, 50, 1, 1, [](double x, double y) {
    return std::floor(5 * std::sin(x / 7) * std::sin(y / 6)) + 400;
  });
  const auto level = fill_depressions(terrain);
  for (int row = 1; row < 49; ++row)
    for (int col = 1; col < 59; ++col) {
      bool lower = false;
      for (int k = 0; k < 8; ++k)
        lower |= level.at(col + impl::neighbour_col[k], row + impl::neighbour_row[k]) < level.at(col, row);
      ASSERT_TRUE(lower) << col << " " << row;
      ASSERT_LE(level.at(col, row) - std::max(terrain.values.at(col, row), 400.0f), 5.01f);
    }
}

TEST(Depressions, ABasinFillsToItsLowestRim) {
  auto basin = surface(9, 9, 1, 1, [](double, double) { return 10.0; });
  for (int row = 2; row < 7; ++row)
    for (int col = 2; col < 7; ++col) basin.values.at(col, row) = 2;
  basin.values.at(0, 4) = basin.values.at(1, 4) = 6;
  const auto level = fill_depressions(basin, {.drain_flats = false});
  EXPECT_EQ(level.at(4, 4), 6);
  EXPECT_EQ(level.at(1, 1), 10);
}

TEST(Depressions, AMissingCellIsAnOutlet) {
  auto basin = surface(9, 9, 1, 1, [](double x, double y) { return std::hypot(x - 4.5, y - 4.5); });
  basin.values.at(4, 4) = raster::no_data;
  const auto level = fill_depressions(basin, {.drain_flats = false});
  for (std::size_t i = 0; i < level.size(); ++i)
    if (!std::isnan(level.data()[i])) {
      EXPECT_EQ(level.data()[i], basin.values.data()[i]);
    }
}

TEST(Depressions, NothingAtAllIsFine) {
  const auto none = surface(4, 3, 1, 1, [](double, double) { return raster::no_data; });
  const auto level = fill_depressions(none);
  for (float v : level.values()) EXPECT_TRUE(std::isnan(v));
}

TEST(Depressions, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  EXPECT_EQ(error_of([&] { fill_depressions(rough(5, 5, 1), {}, progress); }), "cancelled");
}

TEST(RadixHeap, SortsWhatOnlyRises) {
  Random random(3);
  impl::RadixHeap heap;
  std::vector<std::uint32_t> waiting;
  std::uint32_t last = 0;
  for (int step = 0; step < 20000; ++step) {
    if (heap.empty() || random.uniform() < 0.52) {
      const auto key = last + draw_index(random, random.uniform() < 0.1 ? 100000 : 50);
      heap.push(key, 0);
      waiting.push_back(key);
      std::push_heap(waiting.begin(), waiting.end(), std::greater<>());
    } else {
      ASSERT_EQ(heap.top(), waiting.front());
      last = heap.pop().key;
      ASSERT_EQ(last, waiting.front());
      std::pop_heap(waiting.begin(), waiting.end(), std::greater<>());
      waiting.pop_back();
    }
  }
}

TEST(RadixHeap, KeysKeepTheOrderOfFloats) {
  const float values[] = {-1e30f, -2, -1, -1e-40f, 0, 1e-40f, 1, 1.0000001f, 3e38f};
  for (std::size_t i = 1; i < std::size(values); ++i)
    EXPECT_LT(impl::float_key(values[i - 1]), impl::float_key(values[i]));
}

}  // namespace
}  // namespace tafoni::terrain
