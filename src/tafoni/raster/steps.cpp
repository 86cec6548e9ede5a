// Finds the step of quantized heights from the differences of neighbours, and takes terraces out: a plate is
// relaxed, coarse grids first, within half a step of every height.

#include "tafoni/raster/steps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tafoni/core/parallel.h"
#include "tafoni/raster/impl/stencil.h"

namespace tafoni::raster {
namespace {

/// Height differences between neighbours, of at most about a million pairs spread over the grid.
std::vector<float> neighbour_differences(const Grid<float>& grid) {
  constexpr std::size_t wanted = 500'000;
  const int stride = static_cast<int>(std::max<std::size_t>(1, grid.size() / wanted));
  std::vector<float> out;
  for (int row = 0; row < grid.height(); row += stride)
    for (int col = 0; col < grid.width(); ++col) {
      const float here = grid.at(col, row);
      for (const auto& [c, r] : {std::pair{col + 1, row}, std::pair{col, row + 1}}) {
        if (!grid.inside(c, r)) continue;
        const float d = std::abs(grid.at(c, r) - here);
        if (!std::isnan(d)) out.push_back(d);
      }
    }
  return out;
}

/// Moves row by row towards a plate, held within `slack` of `heights`. A row's update reads two rows to
/// either side, so every third row can go at the same time as the others of its kind and the result does not
/// depend on threads.
void sweep_plate(Grid<float>& plate, const Grid<float>& heights, float slack, const impl::Stencil& stencil) {
  constexpr double over = 1.7;
  constexpr int kinds = 3;
  constexpr std::int64_t rows_a_block = 16;
  const auto update_row = [&](int row, int first) {
    for (int col = first; col < plate.width(); col += kinds) {
      const float h = heights.at(col, row);
      if (std::isnan(h)) continue;
      const double old = plate.at(col, row);
      const auto next = static_cast<float>(old + over * (stencil.plate(plate, col, row) - old));
      if (!std::isnan(next)) plate.at(col, row) = std::clamp(next, h - slack, h + slack);
    }
  };
  for (int kind = 0; kind < kinds; ++kind) {
    const std::int64_t rows = (plate.height() - kind + kinds - 1) / kinds;
    parallel_blocks(rows, rows_a_block, [&](int first, int last) {
      for (int i = first; i < last; ++i)
        for (int column = 0; column < kinds; ++column) update_row(i * kinds + kind, column);
    });
  }
}

/// The plate over `heights`: solved at half the resolution first, since wide terraces need far-reaching
/// changes that sweeps alone would take very long to carry.
Grid<float> plate_over(const Grid<float>& heights, float slack, const impl::Stencil& stencil, int level,
                       Progress& progress) {
  Grid<float> plate = heights;
  constexpr int levels = 8, smallest = 8;
  if (level < levels && heights.width() > smallest && heights.height() > smallest) {
    const Grid<float> half = plate_over(impl::halve(heights), slack, stencil, level + 1, progress);
    for (int row = 0; row < plate.height(); ++row)
      for (int col = 0; col < plate.width(); ++col) {
        const float h = heights.at(col, row);
        if (!std::isnan(h))
          plate.at(col, row) = std::clamp(impl::sample_half(half, col, row), h - slack, h + slack);
      }
  }
  const int sweeps = level == 0 ? 16 : 60;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    progress.check();
    sweep_plate(plate, heights, slack, stencil);
  }
  return plate;
}

}  // namespace

double detect_step(const Grid<float>& heights) {
  const std::vector<float> differences = neighbour_differences(heights);
  float highest = 0;
  for (const float v : heights.values())
    if (!std::isnan(v)) highest = std::max(highest, std::abs(v));
  // Rounding of stored floats is no step.
  const float noise = highest * 1e-6f;
  float step = 0;
  for (const float d : differences) {
    if (d > noise && (step == 0 || d < step)) step = d;
  }
  if (step == 0) return 0;
  std::size_t equal = 0, single = 0, multiple = 0;
  for (const float d : differences) {
    const float steps = d / step;
    if (d <= noise)
      ++equal;
    else if (steps < 1.05f)
      ++single;
    if (d > noise && std::abs(steps - std::round(steps)) < 0.05f) ++multiple;
  }
  const std::size_t unequal = differences.size() - equal;
  const bool quantized = multiple * 100 >= unequal * 99;
  const bool terraced = equal * 4 >= differences.size() && single * 10 >= unequal * 3;
  return quantized && terraced ? step : 0.0;
}

void remove_steps(Raster& raster, double step, Progress& progress) {
  progress.begin("smooth");
  const impl::Stencil stencil(raster.placement.dx, raster.placement.dy);
  raster.values = plate_over(raster.values, static_cast<float>(step / 2), stencil, 0, progress);
  progress.end();
}

}  // namespace tafoni::raster
