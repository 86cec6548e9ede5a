// Filling depressions: water rises from the borders and gives every cell the lowest level at which it drains.

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/radix_heap.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain {
namespace {

/// At least a micrometre, or slopes about elevation 0 would be too small to compute with.
float just_above(float level) {
  return std::max(std::nextafter(level, std::numeric_limits<float>::infinity()), level + 1e-6f);
}

/// Priority-Flood [Barnes14 algs. 2, 3]: water rises from the borders; cells that
/// it drowns wait in a plain queue. Always continuing with the lower of the two queues makes the drained
/// surface the lowest one there is.
class Flood {
 public:
  Flood(const raster::Raster& heights, bool drain_flats)
      : heights_(heights.values),
        drain_flats_(drain_flats),
        level_(heights.width(), heights.height(), raster::no_data) {}

  raster::Grid<float> run(Progress& progress) {
    seed();
    constexpr std::uint64_t batch = 1 << 16;
    std::uint64_t done = 0;
    while (!open_.empty() || !pit_.empty()) {
      spread(next());
      if (++done % batch == 0) progress.advance(batch);
    }
    return std::move(level_);
  }

 private:
  /// Every cell beside the border of the grid or a missing cell drains out.
  void seed() {
    for (int row = 0; row < heights_.height(); ++row)
      for (int col = 0; col < heights_.width(); ++col) {
        const float h = heights_.at(col, row);
        if (impl::missing(h) || !drains(col, row)) continue;
        level_.at(col, row) = h;
        push_open(heights_.index(col, row), h);
      }
  }

  bool drains(int col, int row) const {
    for (int k = 0; k < 8; ++k) {
      const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
      if (!heights_.inside(c, r) || impl::missing(heights_.at(c, r))) return true;
    }
    return false;
  }

  std::uint32_t next() {
    if (pit_.empty() || (!open_.empty() && open_.top() < pit_.front().key)) return open_.pop().value;
    const std::uint32_t cell = pit_.front().value;
    pit_.pop_front();
    return cell;
  }

  void spread(std::uint32_t cell) {
    const auto [col, row] = impl::cell_of(heights_, cell);
    const float water = level_.at(col, row);
    const float least = drain_flats_ ? just_above(water) : water;
    for (int k = 0; k < 8; ++k) {
      const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
      if (!heights_.inside(c, r)) continue;
      const std::size_t i = heights_.index(c, r);
      const float h = heights_.data()[i];
      if (impl::missing(h) || !impl::missing(level_.data()[i])) continue;
      level_.data()[i] = h > least ? h : least;
      if (h > least)
        push_open(i, h);
      else
        push_drowned(i, least);
    }
  }

  void push_open(std::size_t i, float h) { open_.push(impl::float_key(h), static_cast<std::uint32_t>(i)); }

  void push_drowned(std::size_t i, float h) {
    const std::uint32_t key = impl::float_key(h);
    if (!pit_.empty() && key < pit_.back().key)
      open_.push(key, static_cast<std::uint32_t>(i));
    else
      pit_.push_back({key, static_cast<std::uint32_t>(i)});
  }

  const raster::Grid<float>& heights_;
  bool drain_flats_;
  raster::Grid<float> level_;  ///< NaN until the water has come
  impl::RadixHeap open_;
  std::deque<impl::RadixHeap::Item> pit_;
};

}  // namespace

raster::Grid<float> fill_depressions(const raster::Raster& heights, const FillSettings& settings,
                                     Progress& progress) {
  impl::check_size(heights);
  progress.begin("filling depressions", heights.values.size(), "cells");
  raster::Grid<float> level = Flood(heights, settings.drain_flats).run(progress);
  progress.end();
  return level;
}

}  // namespace tafoni::terrain
