// Samples a raster bilinearly or by Catmull-Rom, leaving out pixels without data, and resamples whole rasters
// by that or by averages over areas.

#include "tafoni/raster/resample.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/math/whole.h"

namespace tafoni::raster {
namespace {

/// A pixel coordinate split into its whole and its fraction; beyond the outermost centres, those.
struct Split {
  int index;
  double fraction;
};
Split split(double position, int count) {
  const double clamped = std::clamp(position, 0.0, count - 1.0);
  const int index = std::min(static_cast<int>(clamped), std::max(count - 2, 0));
  return {index, clamped - index};
}

/// Catmull-Rom weights of the pixels at -1, 0, 1 and 2.
std::array<double, 4> catmull_rom(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
          0.5 * (t3 - t2)};
}

double bilinear(const Grid<float>& grid, Split x, Split y) {
  const int right = std::min(x.index + 1, grid.width() - 1), below = std::min(y.index + 1, grid.height() - 1);
  const int near_col = x.fraction < 0.5 ? x.index : right, near_row = y.fraction < 0.5 ? y.index : below;
  if (std::isnan(grid.at(near_col, near_row))) return no_data;
  double sum = 0, weight = 0;
  const auto add = [&](int col, int row, double w) {
    const float value = grid.at(col, row);
    if (std::isnan(value)) return;
    sum += w * value;
    weight += w;
  };
  add(x.index, y.index, (1 - x.fraction) * (1 - y.fraction));
  add(right, y.index, x.fraction * (1 - y.fraction));
  add(x.index, below, (1 - x.fraction) * y.fraction);
  add(right, below, x.fraction * y.fraction);
  return sum / weight;
}

double bicubic(const Grid<float>& grid, Split x, Split y) {
  const auto wx = catmull_rom(x.fraction), wy = catmull_rom(y.fraction);
  double sum = 0;
  for (int j = 0; j < 4; ++j) {
    const float* row = grid.row(std::clamp(y.index + j - 1, 0, grid.height() - 1));
    double line = 0;
    for (int i = 0; i < 4; ++i) line += wx[i] * row[std::clamp(x.index + i - 1, 0, grid.width() - 1)];
    sum += wy[j] * line;
  }
  return std::isnan(sum) ? bilinear(grid, x, y) : sum;
}

/// The source pixels [first, last] that a target pixel from `begin` to `end` (source pixel edges) covers.
struct Cover {
  int first, last;
  double begin, end;
  double weight(int pixel) const {
    return std::max(0.0, std::min(end, pixel + 1.0) - std::max(begin, 1.0 * pixel));
  }
};
Cover cover(double begin, double end, int count) {
  const int first = std::clamp(floor_to(begin), 0, count - 1);
  const int last = std::clamp(ceil_to(end) - 1, first, count - 1);
  return {first, last, begin, end};
}

float average(const Grid<float>& grid, const Cover& x, const Cover& y) {
  double sum = 0, weight = 0;
  for (int row = y.first; row <= y.last; ++row)
    for (int col = x.first; col <= x.last; ++col) {
      const float value = grid.at(col, row);
      const double w = x.weight(col) * y.weight(row);
      if (std::isnan(value)) continue;
      sum += w * value;
      weight += w;
    }
  const double whole = (x.end - x.begin) * (y.end - y.begin);
  return weight > 0 && weight >= 0.5 * whole * (1 - 1e-9) ? static_cast<float>(sum / weight) : no_data;
}

}  // namespace

double sample_bilinear(const Raster& raster, double x, double y) {
  const Vec2d p = raster.placement.pixel(x, y);
  return bilinear(raster.values, split(p.x, raster.width()), split(p.y, raster.height()));
}

double sample_bicubic(const Raster& raster, double x, double y) {
  const Vec2d p = raster.placement.pixel(x, y);
  return bicubic(raster.values, split(p.x, raster.width()), split(p.y, raster.height()));
}

Raster resample(const Raster& source, const Placement& placement, int width, int height, Resampling how,
                Progress& progress) {
  Raster out{Grid<float>(width, height), placement, source.crs};
  const Placement& from = source.placement;
  progress.begin("resample", height, "rows");
  parallel_for(
      height,
      [&](int row) {
        const double north = placement.north - row * placement.dy;
        const Cover rows = cover((from.north - north) / from.dy,
                                 (from.north - north + placement.dy) / from.dy, source.height());
        for (int col = 0; col < width; ++col) {
          if (how == Resampling::average) {
            const double west = placement.west + col * placement.dx;
            const Cover cols = cover((west - from.west) / from.dx,
                                     (west + placement.dx - from.west) / from.dx, source.width());
            out.values.at(col, row) = average(source.values, cols, rows);
            continue;
          }
          const Vec2d p = placement.center(col, row);
          out.values.at(col, row) =
              static_cast<float>(how == Resampling::bilinear ? sample_bilinear(source, p.x, p.y)
                                                             : sample_bicubic(source, p.x, p.y));
        }
      },
      progress);
  progress.end();
  return out;
}

Raster at_resolution(const Raster& source, double pixel, Progress& progress) {
  const Placement& from = source.placement;
  const int width = std::max(1, round_to(source.width() * from.dx / pixel));
  const int height = std::max(1, round_to(source.height() * from.dy / pixel));
  const bool coarser = pixel > from.dx || pixel > from.dy;
  return resample(source, {from.west, from.north, pixel, pixel}, width, height,
                  coarser ? Resampling::average : Resampling::bicubic, progress);
}

}  // namespace tafoni::raster
