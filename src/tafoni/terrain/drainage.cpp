// Upslope areas: every cell hands its own on to its lower neighbours, once all higher ones have.

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain {
namespace {

/// Flow by [Freeman91] in topological order: a cell is settled once every higher neighbour is. The order is
/// fixed, so sums come out the same to the last bit.
class Flow {
 public:
  Flow(const raster::Raster& filled, double exponent)
      : heights_(filled.values), exponent_(static_cast<float>(exponent)) {
    const double dx = filled.placement.dx, dy = filled.placement.dy;
    for (int k = 0; k < 8; ++k) {
      const double x = impl::neighbour_col[k] * dx, y = impl::neighbour_row[k] * dy;
      per_metre_[k] = static_cast<float>(1 / std::sqrt(x * x + y * y));
    }
    area_ = raster::Grid<double>(filled.width(), filled.height(), dx * dy);
    waiting_ = raster::Grid<std::uint8_t>(filled.width(), filled.height());
  }

  raster::Grid<float> run(Progress& progress) {
    count_higher();
    std::vector<std::uint32_t> ready;
    const int width = heights_.width(), height = heights_.height();
    for (int row = 0; row < height; ++row) {
      for (int col = 0; col < width; ++col) {
        const auto i = static_cast<std::uint32_t>(heights_.index(col, row));
        if (impl::missing(heights_.data()[i]) || waiting_.data()[i] != 0) continue;
        waiting_.data()[i] = settled;
        ready.push_back(i);
        while (!ready.empty()) {
          const std::uint32_t cell = ready.back();
          ready.pop_back();
          pass_on(cell, ready);
        }
      }
      progress.advance();
    }
    raster::Grid<float> out(width, height, raster::no_data);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (!impl::missing(heights_.data()[i])) out.data()[i] = static_cast<float>(area_.data()[i]);
    return out;
  }

 private:
  static constexpr std::uint8_t settled = 255;

  void count_higher() {
    parallel_for(heights_.height(), [&](int row) {
      for (int col = 0; col < heights_.width(); ++col) {
        const float h = heights_.at(col, row);
        int higher = 0;
        for (int k = 0; k < 8; ++k) {
          const int c = col + impl::neighbour_col[k], n = row + impl::neighbour_row[k];
          higher += heights_.inside(c, n) && heights_.at(c, n) > h;
        }
        waiting_.at(col, row) = static_cast<std::uint8_t>(higher);
      }
    });
  }

  void pass_on(std::uint32_t cell, std::vector<std::uint32_t>& ready) {
    const auto [col, row] = impl::cell_of(heights_, cell);
    const float h = heights_.data()[cell];
    std::uint32_t lower[8];
    float weight[8];
    float steepest = 0;
    int n = 0;
    for (int k = 0; k < 8; ++k) {
      const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
      if (!heights_.inside(c, r) || !(heights_.at(c, r) < h)) continue;
      lower[n] = static_cast<std::uint32_t>(heights_.index(c, r));
      weight[n] = (h - heights_.at(c, r)) * per_metre_[k];
      steepest = std::max(steepest, weight[n++]);
    }
    // Relative to the steepest, powers of the least slopes do not all vanish.
    double total = 0;
    for (int k = 0; k < n; ++k) {
      weight[k] = std::pow(weight[k] / steepest, exponent_);
      total += weight[k];
    }
    for (int k = 0; k < n; ++k) {
      area_.data()[lower[k]] += area_.data()[cell] * (weight[k] / total);
      if (--waiting_.data()[lower[k]] != 0) continue;
      waiting_.data()[lower[k]] = settled;
      ready.push_back(lower[k]);
    }
  }

  const raster::Grid<float>& heights_;
  float exponent_;
  float per_metre_[8];
  raster::Grid<double> area_;
  raster::Grid<std::uint8_t> waiting_;  ///< higher neighbours that are not settled yet
};

}  // namespace

raster::Grid<float> drainage_area(const raster::Raster& filled, double exponent, Progress& progress) {
  impl::check_size(filled);
  progress.begin("drainage area", filled.height(), "rows");
  raster::Grid<float> area = Flow(filled, exponent).run(progress);
  progress.end();
  return area;
}

raster::Grid<float> stream_power(const raster::Grid<float>& area, const raster::Grid<float>& slope) {
  if (area.width() != slope.width() || area.height() != slope.height())
    fail(ErrorKind::internal, "stream power: area and slope differ in size");
  raster::Grid<float> out(area.width(), area.height());
  for (std::size_t i = 0; i < out.size(); ++i) out.data()[i] = std::sqrt(area.data()[i]) * slope.data()[i];
  return out;
}

}  // namespace tafoni::terrain
