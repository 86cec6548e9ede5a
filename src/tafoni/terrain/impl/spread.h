#pragma once
// Gives every cell of a grid the candidate that suits it best, from seeds on some cells [Danielsson80].

#include <cstdint>

#include "tafoni/raster/grid.h"

namespace tafoni::terrain::impl {

/// `best` holds an index or -1. cost(col, row, index) is a distance, plus a constant of the index if wished;
/// a cell learns of a candidate by way of its neighbours, which errs by a small part of a pixel.
template <class Cost>
class Spread {
 public:
  Spread(raster::Grid<std::int32_t>& best, const Cost& cost) : best_(best), cost_(cost) {}

  void run() {
    for (int row = 0; row < best_.height(); ++row) sweep(row, -1);
    for (int row = best_.height() - 1; row >= 0; --row) sweep(row, 1);
  }

  void offer(int col, int row, std::int32_t index) {
    if (index < 0) return;
    std::int32_t& mine = best_.at(col, row);
    if (mine == index) return;
    if (mine < 0 || cost_(col, row, index) < cost_(col, row, mine)) mine = index;
  }

 private:
  /// Takes what the row at `from` knows, then passes it along in both directions.
  void sweep(int row, int from) {
    const int width = best_.width();
    const auto take = [&](int col, int dc, int dr) {
      if (best_.inside(col + dc, row + dr)) offer(col, row, best_.at(col + dc, row + dr));
    };
    for (int col = 0; col < width; ++col) {
      take(col, -1, from);
      take(col, 0, from);
      take(col, 1, from);
      take(col, -1, 0);
    }
    for (int col = width - 1; col >= 0; --col) take(col, 1, 0);
  }

  raster::Grid<std::int32_t>& best_;
  const Cost& cost_;
};

}  // namespace tafoni::terrain::impl
