// Fills holes: a membrane from coarse grids to fine ones, then for each hole by itself a thin plate, relaxed
// until it is at rest.

#include "tafoni/raster/fill.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/raster/distance.h"
#include "tafoni/raster/impl/stencil.h"

namespace tafoni::raster {
namespace {

struct Pixel {
  int col, row;
};

std::vector<Pixel> missing_pixels(const Grid<float>& grid) {
  std::vector<Pixel> out;
  for (int row = 0; row < grid.height(); ++row)
    for (int col = 0; col < grid.width(); ++col)
      if (std::isnan(grid.at(col, row))) out.push_back({col, row});
  return out;
}

/// Fills from coarse to fine, at each level letting a membrane come to rest. `grid` holds some data.
void fill_membrane(Grid<float>& grid, const impl::Stencil& stencil, Progress& progress) {
  const std::vector<Pixel> missing = missing_pixels(grid);
  if (missing.empty()) return;
  progress.check();
  Grid<float> half = impl::halve(grid);
  fill_membrane(half, stencil, progress);
  for (const Pixel p : missing) grid.at(p.col, p.row) = impl::sample_half(half, p.col, p.row);
  constexpr int sweeps = 12;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    progress.check();
    for (const Pixel p : missing)
      grid.at(p.col, p.row) = static_cast<float>(stencil.membrane(grid, p.col, p.row));
  }
}

/// The pixels 4-connected to `start` through NaN, marked in `seen`.
std::vector<Pixel> hole_from(Pixel start, const Grid<float>& grid, Grid<std::uint8_t>& seen) {
  std::vector<Pixel> hole{start};
  seen.at(start.col, start.row) = 1;
  for (std::size_t next = 0; next < hole.size(); ++next) {
    const Pixel p = hole[next];
    for (const Pixel q : {Pixel{p.col - 1, p.row}, Pixel{p.col + 1, p.row}, Pixel{p.col, p.row - 1},
                          Pixel{p.col, p.row + 1}}) {
      if (!grid.inside(q.col, q.row) || seen.at(q.col, q.row) || !std::isnan(grid.at(q.col, q.row))) continue;
      seen.at(q.col, q.row) = 1;
      hole.push_back(q);
    }
  }
  return hole;
}

/// A hole and the part of the grid around it that decides its filling.
struct Crop {
  Pixel lo;
  Grid<float> values;
  bool at_rim;  ///< the hole lies too near the raster's rim for a plate to be held on all sides
};
Crop crop_around(const std::vector<Pixel>& hole, const Grid<float>& grid) {
  Pixel lo = hole.front(), hi = hole.front();
  for (const Pixel p : hole) {
    lo = {std::min(lo.col, p.col), std::min(lo.row, p.row)};
    hi = {std::max(hi.col, p.col), std::max(hi.row, p.row)};
  }
  const bool at_rim = lo.col < 2 || lo.row < 2 || hi.col + 2 >= grid.width() || hi.row + 2 >= grid.height();
  constexpr int margin = 3;
  lo = {std::max(lo.col - margin, 0), std::max(lo.row - margin, 0)};
  hi = {std::min(hi.col + margin, grid.width() - 1), std::min(hi.row + margin, grid.height() - 1)};
  Crop crop{lo, Grid<float>(hi.col - lo.col + 1, hi.row - lo.row + 1), at_rim};
  for (int row = 0; row < crop.values.height(); ++row)
    std::copy_n(grid.row(lo.row + row) + lo.col, crop.values.width(), crop.values.row(row));
  return crop;
}

/// Lets a thin plate over the hole come to rest, starting from the membrane in `crop`, which stays when
/// the plate swings beyond what its surroundings make likely.
void relax_plate(Crop& crop, const std::vector<Pixel>& hole, const impl::Stencil& stencil, Interval around,
                 Progress& progress) {
  // In double: the plate's equations magnify rounding by the fourth power of the hole's width.
  Grid<double> fine(crop.values.width(), crop.values.height());
  std::copy(crop.values.values().begin(), crop.values.values().end(), fine.values().begin());
  constexpr int sweeps = 240;
  constexpr double over = 1.85;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    progress.check();
    for (const Pixel p : hole) {
      double& value = fine.at(p.col - crop.lo.col, p.row - crop.lo.row);
      value += over * (stencil.plate(fine, p.col - crop.lo.col, p.row - crop.lo.row) - value);
    }
  }
  const float slack = 0.5f * (around.hi - around.lo);
  const auto plausible = [&](Pixel p) {
    const auto v = static_cast<float>(fine.at(p.col - crop.lo.col, p.row - crop.lo.row));
    return v >= around.lo - slack && v <= around.hi + slack;
  };
  if (!std::all_of(hole.begin(), hole.end(), plausible)) return;
  for (const Pixel p : hole) {
    const int col = p.col - crop.lo.col, row = p.row - crop.lo.row;
    crop.values.at(col, row) = static_cast<float>(fine.at(col, row));
  }
}

/// Fills one hole in a crop around it, so that the work is proportional to the hole.
void mend(Grid<float>& grid, const std::vector<Pixel>& hole, const impl::Stencil& stencil,
          Progress& progress) {
  Crop crop = crop_around(hole, grid);
  Interval around{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
  for (const float v : crop.values.values())
    if (!std::isnan(v)) around = {std::min(around.lo, v), std::max(around.hi, v)};
  fill_membrane(crop.values, stencil, progress);
  if (!crop.at_rim) relax_plate(crop, hole, stencil, around, progress);
  for (const Pixel p : hole) grid.at(p.col, p.row) = crop.values.at(p.col - crop.lo.col, p.row - crop.lo.row);
}

}  // namespace

FillReport fill_holes(Raster& raster, double distance, Progress& progress) {
  Grid<float>& grid = raster.values;
  Grid<std::uint8_t> valid(grid.width(), grid.height());
  for (std::size_t i = 0; i < grid.size(); ++i) valid.values()[i] = !std::isnan(grid.values()[i]);
  const std::size_t missing = std::count(valid.values().begin(), valid.values().end(), std::uint8_t{0});
  FillReport report{0, missing};
  if (missing == 0 || missing == grid.size() || distance <= 0) return report;

  const Grid<float> away = signed_distance(valid, raster.placement.dx, raster.placement.dy, progress);
  const impl::Stencil stencil(raster.placement.dx, raster.placement.dy);
  Grid<std::uint8_t> seen(grid.width(), grid.height());
  std::vector<std::vector<Pixel>> holes;
  for (int row = 0; row < grid.height(); ++row)
    for (int col = 0; col < grid.width(); ++col) {
      if (valid.at(col, row) || seen.at(col, row)) continue;
      auto hole = hole_from({col, row}, grid, seen);
      const bool small =
          std::all_of(hole.begin(), hole.end(), [&](Pixel p) { return -away.at(p.col, p.row) <= distance; });
      if (small) holes.push_back(std::move(hole));
    }
  progress.begin("fill holes", holes.size(), "holes");
  for (const auto& hole : holes) {
    mend(grid, hole, stencil, progress);
    report.filled += hole.size();
    progress.advance();
  }
  progress.end();
  report.left -= report.filled;
  return report;
}

void fill_all(Raster& raster, Progress& progress) {
  const auto& values = raster.values.values();
  if (std::all_of(values.begin(), values.end(), [](float v) { return std::isnan(v); }))
    fail(ErrorKind::input, "the elevations hold no data at all.");
  fill_membrane(raster.values, impl::Stencil(raster.placement.dx, raster.placement.dy), progress);
}

}  // namespace tafoni::raster
