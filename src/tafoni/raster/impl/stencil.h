#pragma once
// One Gauss-Seidel update of a membrane (Laplace) or a thin plate (biharmonic) on a grid of dx by dy pixels.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tafoni/raster/grid.h"

namespace tafoni::raster::impl {

class Stencil {
 public:
  Stencil(double dx, double dy)
      : wx_(dy / dx),
        wy_(dx / dy),
        per_center_(1 / (4 * (wx_ + wy_) * (wx_ + wy_) + 2 * wx_ * wx_ + 2 * wy_ * wy_)),
        east_(4 * wx_ * (wx_ + wy_)),
        north_(4 * wy_ * (wx_ + wy_)),
        diagonal_(2 * wx_ * wy_) {}

  /// The height at which the membrane over the finite neighbours is at rest; NaN when there is none.
  template <class T>
  double membrane(const Grid<T>& g, int col, int row) const {
    double sum = 0, weight = 0;
    const auto add = [&](int c, int r, double w) {
      if (!g.inside(c, r) || std::isnan(g.at(c, r))) return;
      sum += w * g.at(c, r);
      weight += w;
    };
    add(col - 1, row, wx_);
    add(col + 1, row, wx_);
    add(col, row - 1, wy_);
    add(col, row + 1, wy_);
    return sum / weight;
  }

  /// The height at which the plate over the 12 neighbours is at rest; the membrane's where one is missing.
  template <class T>
  double plate(const Grid<T>& g, int col, int row) const {
    if (col < 2 || row < 2 || col + 2 >= g.width() || row + 2 >= g.height()) return membrane(g, col, row);
    const T* p = g.row(row) + col;
    const std::ptrdiff_t w = g.width();
    const auto v = [p](std::ptrdiff_t i) -> double { return p[i]; };
    const double rest = east_ * (v(-1) + v(1)) + north_ * (v(-w) + v(w)) -
                        diagonal_ * (v(-w - 1) + v(-w + 1) + v(w - 1) + v(w + 1)) -
                        wx_ * wx_ * (v(-2) + v(2)) - wy_ * wy_ * (v(-2 * w) + v(2 * w));
    return std::isnan(rest) ? membrane(g, col, row) : rest * per_center_;
  }

 private:
  double wx_, wy_, per_center_, east_, north_, diagonal_;
};

/// Half the resolution, rounded up: the mean of up to four finite pixels, NaN where there is none.
inline Grid<float> halve(const Grid<float>& g) {
  Grid<float> half((g.width() + 1) / 2, (g.height() + 1) / 2, no_data);
  for (int row = 0; row < half.height(); ++row)
    for (int col = 0; col < half.width(); ++col) {
      double sum = 0;
      int count = 0;
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
          if (!g.inside(2 * col + i, 2 * row + j) || std::isnan(g.at(2 * col + i, 2 * row + j))) continue;
          sum += g.at(2 * col + i, 2 * row + j);
          ++count;
        }
      if (count > 0) half.at(col, row) = static_cast<float>(sum / count);
    }
  return half;
}

/// The bilinear value of the half-resolution grid at a pixel of the full one. NaN neighbours take no part.
inline float sample_half(const Grid<float>& half, int col, int row) {
  const int c = col / 2, r = row / 2;
  const int c2 = std::clamp(c + (col % 2 ? 1 : -1), 0, half.width() - 1);
  const int r2 = std::clamp(r + (row % 2 ? 1 : -1), 0, half.height() - 1);
  double sum = 0, weight = 0;
  const auto add = [&](int i, int j, double w) {
    if (std::isnan(half.at(i, j))) return;
    sum += w * half.at(i, j);
    weight += w;
  };
  add(c, r, 9);
  add(c2, r, 3);
  add(c, r2, 3);
  add(c2, r2, 1);
  return static_cast<float>(sum / weight);
}

}  // namespace tafoni::raster::impl
