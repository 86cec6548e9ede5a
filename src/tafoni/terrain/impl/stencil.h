#pragma once
// The eight neighbours of a cell, and heights looked up with care for borders and missing cells.

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tafoni/core/error.h"
#include "tafoni/raster/grid.h"

namespace tafoni::terrain::impl {

inline constexpr int neighbour_col[8] = {-1, 0, 1, -1, 1, -1, 0, 1};
inline constexpr int neighbour_row[8] = {-1, -1, -1, 0, 0, 1, 1, 1};

inline bool missing(float h) {
  return std::isnan(h);
}

struct Cell {
  int col, row;
};
/// The cell of this number.
template <class T, class Index>
Cell cell_of(const raster::Grid<T>& grid, Index i) {
  const Index width = static_cast<Index>(grid.width());
  return {static_cast<int>(i % width), static_cast<int>(i / width)};
}

/// dh/dx (east) and dh/dy (north), by central differences; one-sided, then 0, where neighbours lack.
inline Vec2d gradient(const raster::Raster& heights, int col, int row) {
  const auto& grid = heights.values;
  const float here = grid.at(col, row);
  const auto difference = [&](int dc, int dr, double step) {
    const bool ahead = grid.inside(col + dc, row + dr) && !missing(grid.at(col + dc, row + dr));
    const bool behind = grid.inside(col - dc, row - dr) && !missing(grid.at(col - dc, row - dr));
    const double a = ahead ? grid.at(col + dc, row + dr) : here;
    const double b = behind ? grid.at(col - dc, row - dr) : here;
    return ahead || behind ? (a - b) / (step * (ahead + behind)) : 0.0;
  };
  return {difference(1, 0, heights.placement.dx), difference(0, -1, heights.placement.dy)};
}

/// Cells are numbered with 32 bits.
inline void check_size(const raster::Raster& heights) {
  if (heights.values.size() >= (std::size_t{1} << 32))
    fail(ErrorKind::input, "a grid of {} x {} cells is too large to analyse at once; cut out a window",
         heights.width(), heights.height());
}

}  // namespace tafoni::terrain::impl
