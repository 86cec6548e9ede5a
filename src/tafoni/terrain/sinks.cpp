// Closed depressions: what lies below the filled surface, gathered to one sink for each connected set.

#include <algorithm>

#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain {
namespace {

/// Collects the cells below the filled surface that hang together with `first`. They share one water level:
/// a higher one would spill into a lower one.
Sink gather(const raster::Raster& heights, const raster::Grid<float>& level, std::size_t first,
            std::vector<bool>& seen, std::vector<std::size_t>& stack) {
  const raster::Grid<float>& grid = heights.values;
  const double cell_area = heights.placement.dx * heights.placement.dy;
  std::size_t deepest = first;
  double depths = 0;
  std::uint64_t cells = 0;
  seen[first] = true;
  stack.assign(1, first);
  while (!stack.empty()) {
    const std::size_t i = stack.back();
    stack.pop_back();
    const float h = grid.data()[i];
    ++cells;
    depths += level.data()[i] - double{h};
    if (h < grid.data()[deepest] || (h == grid.data()[deepest] && i < deepest)) deepest = i;
    const auto [col, row] = impl::cell_of(grid, i);
    for (int k = 0; k < 8; ++k) {
      const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
      if (!grid.inside(c, r)) continue;
      const std::size_t n = grid.index(c, r);
      if (seen[n] || !(level.data()[n] > grid.data()[n])) continue;
      seen[n] = true;
      stack.push_back(n);
    }
  }
  const auto [col, row] = impl::cell_of(grid, deepest);
  return {.col = col,
          .row = row,
          .elevation = grid.data()[deepest],
          .spill = level.data()[deepest],
          .area = static_cast<double>(cells) * cell_area,
          .volume = depths * cell_area};
}

}  // namespace

std::vector<Sink> sinks(const raster::Raster& heights, const SinkSettings& settings, Progress& progress) {
  const raster::Grid<float> level = fill_depressions(heights, {.drain_flats = false}, progress);
  const raster::Grid<float>& grid = heights.values;
  progress.begin("sinks", grid.height(), "rows");
  std::vector<bool> seen(grid.size(), false);
  std::vector<std::size_t> stack;
  std::vector<Sink> found;
  for (int row = 0; row < grid.height(); ++row) {
    for (int col = 0; col < grid.width(); ++col) {
      const std::size_t i = grid.index(col, row);
      if (seen[i] || !(level.data()[i] > grid.data()[i])) continue;
      const Sink sink = gather(heights, level, i, seen, stack);
      if (sink.depth() >= settings.min_depth && sink.area >= settings.min_area) found.push_back(sink);
    }
    progress.advance();
  }
  std::sort(found.begin(), found.end(),
            [](const Sink& a, const Sink& b) { return a.row != b.row ? a.row < b.row : a.col < b.col; });
  progress.end();
  return found;
}

}  // namespace tafoni::terrain
