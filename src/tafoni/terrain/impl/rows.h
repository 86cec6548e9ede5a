#pragma once
// An elevation model made row by row.

#include <string_view>

#include "tafoni/core/parallel.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::terrain::impl {

/// fill(row, placement, heights) writes the heights of one row, from any thread.
template <class Fill>
raster::Raster by_rows(const GridSettings& grid, std::string_view stage, Progress& progress,
                       const Fill& fill) {
  const int width = static_cast<int>(grid.width), height = static_cast<int>(grid.height);
  raster::Raster out{
      raster::Grid<float>(width, height), {0, height * grid.pixel, grid.pixel, grid.pixel}, {}};
  progress.begin(stage, static_cast<std::uint64_t>(height), "rows");
  parallel_for(
      height,
      [&](std::int64_t i) {
        const int row = static_cast<int>(i);
        fill(row, out.placement, out.values.row(row));
      },
      progress);
  progress.end();
  return out;
}

}  // namespace tafoni::terrain::impl
