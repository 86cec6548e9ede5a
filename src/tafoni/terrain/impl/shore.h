#pragma once
// A shoreline on a grid, for generators.

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "tafoni/terrain/impl/contour.h"

namespace tafoni::terrain::impl {

/// A line on the map: the zero of a function that is positive on its landward side.
struct Shore {
  raster::Raster inside;
  Contour contour;

  /// The distance of p, in cell i, from the line, positive on land, and the line's nearest point. Where there
  /// is no line it lies far away.
  std::pair<double, Vec2d> distance(std::size_t i, Vec2d p) const {
    constexpr double far = 1e4;
    const bool in = inside.values.data()[i] > 0;
    const std::int32_t nearest = contour.nearest.data()[i];
    if (nearest < 0) return {in ? far : -far, p};
    const Vec2d s = contour.points[nearest];
    const double d = std::hypot(p.x - s.x, p.y - s.y);
    return {in ? d : -d, s};
  }
};

/// Sea that the open sea does not reach becomes land; that lies beyond the western, southern and eastern
/// edge.
inline void drop_lagoons(raster::Grid<float>& land) {
  const int width = land.width(), height = land.height();
  raster::Grid<std::uint8_t> open(width, height);
  std::vector<std::pair<int, int>> stack;
  const auto visit = [&](int col, int row) {
    if (!open.inside(col, row) || open.at(col, row) || land.at(col, row) > 0) return;
    open.at(col, row) = 1;
    stack.emplace_back(col, row);
  };
  for (int col = 0; col < width; ++col) visit(col, height - 1);
  for (int row = 0; row < height; ++row) {
    visit(0, row);
    visit(width - 1, row);
  }
  while (!stack.empty()) {
    const auto [col, row] = stack.back();
    stack.pop_back();
    visit(col - 1, row);
    visit(col + 1, row);
    visit(col, row - 1);
    visit(col, row + 1);
  }
  for (std::size_t i = 0; i < open.size(); ++i)
    if (!open.data()[i] && land.data()[i] <= 0) land.data()[i] = 0.5f;
}

}  // namespace tafoni::terrain::impl
