#include "tafoni/raster/collar.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tafoni::raster {
namespace {

constexpr std::size_t least_piece = 16;

struct CollarPixel {
  int col, row;
};

class CollarSearch {
 public:
  CollarSearch(Grid<float>& heights, float value, double limit)
      : heights_(heights), value_(value), limit_(limit), seen_(heights.width(), heights.height(), 0) {}

  Collar run() {
    const int right = heights_.width() - 1, bottom = heights_.height() - 1;
    for (int col = 0; col <= right; ++col) start({col, 0}), start({col, bottom});
    for (int row = 0; row <= bottom; ++row) start({0, row}), start({right, row});
    return collar_;
  }

 private:
  void start(CollarPixel from) {
    if (seen_.at(from.col, from.row) || heights_.at(from.col, from.row) != value_) return;
    std::vector<CollarPixel> piece{from};
    seen_.at(from.col, from.row) = 1;
    double beside = std::numeric_limits<double>::infinity();
    for (std::size_t next = 0; next < piece.size(); ++next) {
      const CollarPixel p = piece[next];
      for (const CollarPixel q : {CollarPixel{p.col - 1, p.row}, CollarPixel{p.col + 1, p.row},
                                  CollarPixel{p.col, p.row - 1}, CollarPixel{p.col, p.row + 1}}) {
        if (!heights_.inside(q.col, q.row)) continue;
        const float h = heights_.at(q.col, q.row);
        if (h != value_) {
          beside = std::isnan(h) ? beside : std::min<double>(beside, std::abs(h - value_));
        } else if (!seen_.at(q.col, q.row)) {
          seen_.at(q.col, q.row) = 1;
          piece.push_back(q);
        }
      }
    }
    if (piece.size() < least_piece || !(beside > limit_) || std::isinf(beside)) return;
    for (const CollarPixel p : piece) heights_.at(p.col, p.row) = no_data;
    collar_.lowest_beside = collar_.pixels > 0 ? std::min(collar_.lowest_beside, beside) : beside;
    collar_.pixels += piece.size();
  }

  Grid<float>& heights_;
  float value_;
  double limit_;
  Grid<std::uint8_t> seen_;
  Collar collar_;
};

}  // namespace

Collar remove_collar(Grid<float>& heights, float value, double limit) {
  return CollarSearch(heights, value, limit).run();
}

}  // namespace tafoni::raster
