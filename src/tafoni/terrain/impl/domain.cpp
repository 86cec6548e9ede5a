// The domain: distances to the border of the data, blurred so that a ragged border becomes one to walk along,
// without islets.

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
constexpr int blur_passes = 3;               // box blurs; three come close to a Gaussian
constexpr int data_blur = 2, land_blur = 1;  // their radii: of the data's border; of that without islets
constexpr double islet = 4;                  // pixels: islands nowhere farther from their border are left out

/// Replaces each row by the mean of the 2 `radius` + 1 rows around it, the outermost going on beyond the
/// ends.
void box_blur(Grid<float>& rows, int radius) {
  Grid<float> out(rows.width(), rows.height());
  const float weight = 1 / static_cast<float>(2 * radius + 1);
  for (int i = 0; i < rows.height(); ++i) {
    float* to = out.row(i);
    for (int k = i - radius; k <= i + radius; ++k) {
      const float* from = rows.row(std::clamp(k, 0, rows.height() - 1));
      for (int j = 0; j < rows.width(); ++j) to[j] += weight * from[j];
    }
  }
  rows = std::move(out);
}

/// Both directions work on blocks gathered so that the blur runs across rows, which is contiguous.
void blur(Grid<float>& grid, int radius) {
  const int width = grid.width(), height = grid.height();
  parallel_blocks(width, lines_a_block, [&](int first, int last) {
    const int columns = last - first;
    Grid<float> block(columns, height);
    for (int row = 0; row < height; ++row) std::copy_n(grid.row(row) + first, columns, block.row(row));
    for (int pass = 0; pass < blur_passes; ++pass) box_blur(block, radius);
    for (int row = 0; row < height; ++row) std::copy_n(block.row(row), columns, grid.row(row) + first);
  });
  parallel_blocks(height, lines_a_block, [&](int top, int end) {
    const int rows = end - top;
    Grid<float> block(rows, width);  // turned over: its rows are columns of the grid
    for (int row = 0; row < rows; ++row)
      for (int col = 0; col < width; ++col) block.at(row, col) = grid.at(col, top + row);
    for (int pass = 0; pass < blur_passes; ++pass) box_blur(block, radius);
    for (int row = 0; row < rows; ++row)
      for (int col = 0; col < width; ++col) grid.at(col, top + row) = block.at(row, col);
  });
}

/// Pixels [first, last) of one row that belong together.
struct Run {
  int row, first, last;
  std::size_t parent;  ///< another run of the same island, or itself
  bool large;          ///< of the root: the island reaches far enough from its border
};

std::size_t root_of(std::vector<Run>& runs, std::size_t i) {
  while (runs[i].parent != i) i = runs[i].parent = runs[runs[i].parent].parent;
  return i;
}

/// The runs of positive `distance`, joined to islands through 4-neighbours.
std::vector<Run> islands_of(const Grid<float>& distance, float least) {
  std::vector<Run> runs;
  std::size_t above = 0, above_end = 0;
  for (int row = 0; row < distance.height(); ++row) {
    const std::size_t here = runs.size();
    for (int col = 0; col < distance.width();) {
      if (!(distance.at(col, row) > 0)) {
        ++col;
        continue;
      }
      Run run{row, col, col, runs.size(), false};
      for (; run.last < distance.width() && distance.at(run.last, row) > 0; ++run.last)
        run.large = run.large || distance.at(run.last, row) > least;
      col = run.last;
      runs.push_back(run);
      while (above < above_end && runs[above].last <= run.first) ++above;
      for (std::size_t i = above; i < above_end && runs[i].first < run.last; ++i) {
        const std::size_t a = root_of(runs, i), b = root_of(runs, runs.size() - 1);
        runs[a].large = runs[a].large || runs[b].large;
        runs[b].parent = a;
      }
    }
    above = here;
    above_end = runs.size();
  }
  return runs;
}

/// 1 where `distance` is positive, without islands nowhere farther than `least` from the border, unless all
/// are such.
Grid<std::uint8_t> drop_islets(const Grid<float>& distance, float least) {
  std::vector<Run> runs = islands_of(distance, least);
  bool any = false;
  for (std::size_t i = 0; i < runs.size(); ++i) any = any || runs[root_of(runs, i)].large;
  Grid<std::uint8_t> out(distance.width(), distance.height());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (any && !runs[root_of(runs, i)].large) continue;
    std::fill(out.row(runs[i].row) + runs[i].first, out.row(runs[i].row) + runs[i].last, std::uint8_t{1});
  }
  return out;
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
  blur(smooth, data_blur);
  const Grid<std::uint8_t> land = drop_islets(smooth, static_cast<float>(islet * std::max(dx, dy)));
  if (whole(land)) return {};
  Grid<float> distance = raster::signed_distance(land, dx, dy, progress);
  blur(distance, land_blur);
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
