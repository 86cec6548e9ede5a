// How large a sphere can touch the ground at each cell. A pyramid of greatest heights lets a search from near
// to far leave out what no sphere reaches.

#include <algorithm>
#include <cmath>
#include <limits>

#include "tafoni/core/parallel.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain {
namespace {

constexpr float nothing = -std::numeric_limits<float>::infinity();

/// Maxima over blocks of 2^level cells a side; missing cells count as infinitely deep.
std::vector<raster::Grid<float>> max_pyramid(const raster::Grid<float>& heights, int levels) {
  std::vector<raster::Grid<float>> pyramid;
  raster::Grid<float> base = heights;
  for (float& h : base.values())
    if (impl::missing(h)) h = nothing;
  pyramid.push_back(std::move(base));
  for (int level = 1; level < levels; ++level) {
    const raster::Grid<float>& fine = pyramid.back();
    raster::Grid<float> coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2, nothing);
    parallel_blocks(coarse.height(), 64, [&](int begin, int end) {
      const int first = 2 * begin, last = std::min(2 * end, fine.height());
      for (int row = first; row < last; ++row)
        for (int col = 0; col < fine.width(); ++col) {
          float& most = coarse.at(col / 2, row / 2);
          most = std::max(most, fine.at(col, row));
        }
    });
    pyramid.push_back(std::move(coarse));
  }
  return pyramid;
}

/// Finds, for one cell after another, the largest free tangent sphere. Blocks are searched from near to far;
/// one that the best sphere so far does not reach holds nothing that could shrink it.
class Search {
 public:
  Search(const raster::Raster& heights, const std::vector<raster::Grid<float>>& pyramid, double max_radius)
      : heights_(heights),
        pyramid_(pyramid),
        dx_(heights.placement.dx),
        dy_(heights.placement.dy),
        max_radius_(max_radius) {}

  double radius(int col, int row) {
    const Vec2d g = impl::gradient(heights_, col, row);
    normal_ = normalized(Vec3d{-g.x, -g.y, 1});
    col_ = col;
    row_ = row;
    height_ = pyramid_[0].at(col, row);
    best_ = max_radius_;
    for (int r = -1; r <= 1; ++r)
      for (int c = -1; c <= 1; ++c) visit(0, col + c, row + r);
    const int levels = static_cast<int>(pyramid_.size());
    for (int level = 0; level + 1 < levels && reaches(level); ++level) ring(level);
    return best_;
  }

 private:
  /// Whether a sphere of the best radius can touch what lies beyond the 3 x 3 blocks about the cell.
  bool reaches(int level) const { return 2 * best_ > std::ldexp(std::min(dx_, dy_), level) * 0.999; }

  /// The blocks below the 3 x 3 parents about the cell that are not among its own 3 x 3.
  void ring(int level) {
    const int bc = col_ >> level, br = row_ >> level;
    const int pc = 2 * (bc >> 1), pr = 2 * (br >> 1);
    for (int r = pr - 2; r < pr + 4; ++r)
      for (int c = pc - 2; c < pc + 4; ++c)
        if (std::abs(r - br) > 1 || std::abs(c - bc) > 1) visit(level, c, r);
  }

  void visit(int level, int block_col, int block_row) {
    const raster::Grid<float>& grid = pyramid_[level];
    if (!grid.inside(block_col, block_row)) return;
    const double rise = grid.at(block_col, block_row) - height_;
    if (!in_sphere(level, block_col, block_row, rise)) return;
    if (level == 0) {
      shrink((block_col - col_) * dx_, (row_ - block_row) * dy_, rise);
      return;
    }
    for (int k = 0; k < 4; ++k) visit(level - 1, 2 * block_col + (k & 1), 2 * block_row + (k >> 1));
  }

  /// Whether the best sphere so far cuts the column over the block's cell centres up to `rise`.
  bool in_sphere(int level, int block_col, int block_row, double rise) const {
    const int extent = (1 << level) - 1;
    const double west = ((block_col << level) - col_) * dx_, east = west + extent * dx_;
    const double north = (row_ - (block_row << level)) * dy_, south = north - extent * dy_;
    const Vec3d center = normal_ * best_;
    const double x = std::max({west - center.x, center.x - east, 0.0});
    const double y = std::max({south - center.y, center.y - north, 0.0});
    const double z = std::max(center.z - rise, 0.0);
    return x * x + y * y + z * z < best_ * best_;
  }

  /// The tangent sphere through a point at d has radius |d|^2 / (2 n.d); of the column's points the one at
  /// the height that makes it least counts.
  void shrink(double x, double y, double rise) {
    const double flat = x * x + y * y;
    if (flat == 0) return;
    const double a = normal_.x * x + normal_.y * y, b = normal_.z;
    const double z = std::min(rise, (std::sqrt(a * a + b * b * flat) - a) / b);
    const double toward = a + b * z;
    if (toward > 0) best_ = std::min(best_, (flat + z * z) / (2 * toward));
  }

  const raster::Raster& heights_;
  const std::vector<raster::Grid<float>>& pyramid_;
  double dx_, dy_, max_radius_;
  Vec3d normal_;
  int col_ = 0, row_ = 0;
  double height_ = 0, best_ = 0;
};

}  // namespace

raster::Grid<float> accessibility(const raster::Raster& heights, const AccessibilitySettings& settings,
                                  Progress& progress) {
  if (!(settings.max_radius > 0) || !std::isfinite(settings.max_radius))
    fail(ErrorKind::usage, "accessibility: the greatest radius must be above 0 m, not {}",
         settings.max_radius);
  const int width = heights.width(), height = heights.height();
  const double reach = 2 * settings.max_radius / std::min(heights.placement.dx, heights.placement.dy);
  int levels = 2;
  while (levels < 16 && std::ldexp(1.0, levels - 1) < reach) ++levels;
  const auto pyramid = max_pyramid(heights.values, levels);
  raster::Grid<float> out(width, height, raster::no_data);
  const auto asked = [&](int col, int row) {
    return !impl::missing(heights.values.at(col, row)) &&
           (!settings.wanted || settings.wanted->at(col, row) != 0);
  };
  progress.begin("accessibility", height, "rows");
  parallel_for(
      height,
      [&](int row) {
        Search search(heights, pyramid, settings.max_radius);
        for (int col = 0; col < width; ++col)
          if (asked(col, row))
            out.at(col, row) = static_cast<float>(search.radius(col, row) / settings.max_radius);
      },
      progress);
  progress.end();
  return out;
}

}  // namespace tafoni::terrain
