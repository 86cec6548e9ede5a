#include "tafoni/terrain/impl/domain.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "tafoni/core/parallel.h"
#include "tafoni/raster/distance.h"

namespace tafoni::terrain::impl {
namespace {

using raster::Grid;

constexpr std::int64_t lines_a_block = 64;

/// The mean over 2 `radius` + 1 values of a line, whose ends go on; `stride` apart.
void box_blur(float* line, int count, std::ptrdiff_t stride, int radius, std::vector<float>& copy) {
  copy.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) copy[static_cast<std::size_t>(i)] = line[i * stride];
  const auto at = [&](int i) { return copy[static_cast<std::size_t>(std::clamp(i, 0, count - 1))]; };
  for (int i = 0; i < count; ++i) {
    float sum = 0;
    for (int k = -radius; k <= radius; ++k) sum += at(i + k);
    line[i * stride] = sum / static_cast<float>(2 * radius + 1);
  }
}

/// Three box blurs each way: close to a Gaussian.
void blur(Grid<float>& grid, int radius) {
  constexpr int passes = 3;
  const int width = grid.width(), height = grid.height();
  parallel_blocks(height, lines_a_block, [&](std::int64_t first, std::int64_t last) {
    std::vector<float> copy;
    for (int row = static_cast<int>(first); row < last; ++row)
      for (int pass = 0; pass < passes; ++pass) box_blur(grid.row(row), width, 1, radius, copy);
  });
  parallel_blocks(width, lines_a_block, [&](std::int64_t first, std::int64_t last) {
    std::vector<float> copy;
    for (int col = static_cast<int>(first); col < last; ++col)
      for (int pass = 0; pass < passes; ++pass) box_blur(grid.data() + col, height, width, radius, copy);
  });
}

/// The 4-connected pixels of `mask` around one, which leave it.
std::vector<std::pair<int, int>> take_island(Grid<std::uint8_t>& mask, int col, int row) {
  std::vector<std::pair<int, int>> out{{col, row}};
  mask.at(col, row) = 0;
  for (std::size_t next = 0; next < out.size(); ++next) {
    const auto [c, r] = out[next];
    for (const auto& [i, j] : {std::pair{c - 1, r}, {c + 1, r}, {c, r - 1}, {c, r + 1}}) {
      if (!mask.inside(i, j) || !mask.at(i, j)) continue;
      mask.at(i, j) = 0;
      out.emplace_back(i, j);
    }
  }
  return out;
}

/// 1 where `distance` is positive, without islands nowhere farther than `least` from the border.
Grid<std::uint8_t> without_islets(const Grid<float>& distance, float least) {
  Grid<std::uint8_t> left(distance.width(), distance.height()), kept = left;
  for (std::size_t i = 0; i < left.size(); ++i) left.values()[i] = distance.values()[i] > 0;
  const Grid<std::uint8_t> all = left;
  bool any = false;
  for (int row = 0; row < left.height(); ++row)
    for (int col = 0; col < left.width(); ++col) {
      if (!left.at(col, row)) continue;
      const auto island = take_island(left, col, row);
      const bool large = std::any_of(island.begin(), island.end(),
                                     [&](const auto& p) { return distance.at(p.first, p.second) > least; });
      if (!large) continue;
      any = true;
      for (const auto& [c, r] : island) kept.at(c, r) = 1;
    }
  return any ? kept : all;
}

}  // namespace

Grid<float> data_distance(const raster::Raster& world, Progress& progress) {
  const double dx = world.placement.dx, dy = world.placement.dy;
  Grid<std::uint8_t> mask(world.width(), world.height());
  for (std::size_t i = 0; i < mask.size(); ++i) mask.values()[i] = !std::isnan(world.values.values()[i]);
  const auto whole = [](const Grid<std::uint8_t>& m) {
    return std::all_of(m.values().begin(), m.values().end(), [](std::uint8_t v) { return v != 0; });
  };
  if (whole(mask)) return {};
  Grid<float> smooth = raster::signed_distance(mask, dx, dy, progress);
  blur(smooth, 2);
  constexpr double pixels = 4;
  const Grid<std::uint8_t> land = without_islets(smooth, static_cast<float>(pixels * std::max(dx, dy)));
  if (whole(land)) return {};
  Grid<float> distance = raster::signed_distance(land, dx, dy, progress);
  blur(distance, 1);
  const bool vanished =
      std::none_of(distance.values().begin(), distance.values().end(), [](float d) { return d > 0; });
  if (vanished) return raster::signed_distance(mask, dx, dy, progress);
  return distance;
}

Grid<float> domain_distance(const raster::Raster& world, const std::vector<std::vector<Vec2d>>& polygons,
                            double band, Progress& progress) {
  Grid<float> out = data_distance(world, progress);
  if (!polygons.empty()) {
    Grid<float> polygon =
        raster::signed_distance(polygons, world.placement, world.width(), world.height(), band, progress);
    for (std::size_t i = 0; i < out.size(); ++i)
      polygon.values()[i] = std::min(polygon.values()[i], out.values()[i]);
    out = std::move(polygon);
  }
  const auto limit = static_cast<float>(band);
  for (float& d : out.values()) d = std::clamp(d, -limit, limit);
  return out;
}

}  // namespace tafoni::terrain::impl
