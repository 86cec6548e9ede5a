#pragma once
// An elevation model made row by row.

#include <span>
#include <string_view>
#include <vector>

#include "tafoni/core/parallel.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::terrain::impl {

/// Where a generator's map lies: its south-west corner at (0, 0).
inline raster::Placement placement_of(const GridSettings& grid) {
  return {0, grid.extent().y, grid.pixel, grid.pixel};
}

/// The centres of the pixels of one row.
inline std::vector<Vec2d> row_points(const GridSettings& grid, int row) {
  const raster::Placement placement = placement_of(grid);
  std::vector<Vec2d> out;
  for (int col = 0; col < grid.columns(); ++col) out.push_back(placement.center(col, row));
  return out;
}

/// Calls body(row, the row's points) for every row, from any thread.
template <class Body>
void for_rows(const GridSettings& grid, Progress& progress, const Body& body) {
  const auto one = [&](int row) { body(row, row_points(grid, row)); };
  parallel_for(grid.rows(), one, progress);
}

/// fill(row, points, heights) works out the heights of one row, from any thread. Counts a step a row.
template <class Fill>
raster::Raster fill_rows(const GridSettings& grid, Progress& progress, const Fill& fill) {
  raster::Raster out{raster::Grid<float>(grid.columns(), grid.rows()), placement_of(grid), {}};
  for_rows(grid, progress, [&](int row, const std::vector<Vec2d>& points) {
    std::vector<double> heights(points.size());
    fill(row, points, std::span(heights));
    for (int col = 0; col < out.width(); ++col) out.values.at(col, row) = static_cast<float>(heights[col]);
  });
  return out;
}

/// fill_rows() as a stage of its own.
template <class Fill>
raster::Raster by_rows(const GridSettings& grid, std::string_view stage, Progress& progress,
                       const Fill& fill) {
  progress.begin(stage, grid.height, "rows");
  raster::Raster out = fill_rows(grid, progress, fill);
  progress.end();
  return out;
}

/// by_rows() where a height depends on its own place alone: height(p).
template <class Height>
raster::Raster by_points(const GridSettings& grid, std::string_view stage, Progress& progress,
                         const Height& height) {
  return by_rows(grid, stage, progress, [&](int, const std::vector<Vec2d>& points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = height(points[i]);
  });
}

}  // namespace tafoni::terrain::impl
