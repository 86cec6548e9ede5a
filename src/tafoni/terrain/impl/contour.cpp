#include "tafoni/terrain/impl/contour.h"

#include <utility>

#include "tafoni/terrain/impl/spread.h"

namespace tafoni::terrain::impl {
namespace {

double squared(Vec2d a) {
  return a.x * a.x + a.y * a.y;
}

class Tracer {
 public:
  explicit Tracer(const raster::Raster& values) : values_(values), spread_(out_.nearest, away_) {
    out_.nearest = raster::Grid<std::int32_t>(values.width(), values.height(), -1);
  }

  Contour run() {
    const int width = values_.width(), height = values_.height();
    for (int row = 0; row < height; ++row)
      for (int col = 0; col < width; ++col) {
        if (col + 1 < width) cross(col, row, col + 1, row);
        if (row + 1 < height) cross(col, row, col, row + 1);
      }
    spread_.run();
    return std::move(out_);
  }

 private:
  struct Away {
    const Tracer& tracer;
    double operator()(int col, int row, std::int32_t point) const {
      return squared(tracer.out_.points[point] - tracer.values_.placement.center(col, row));
    }
  };

  void cross(int col, int row, int col2, int row2) {
    const double a = values_.values.at(col, row), b = values_.values.at(col2, row2);
    if ((a > 0) == (b > 0)) return;
    const double t = a / (a - b);
    out_.points.push_back(values_.placement.center(col + t * (col2 - col), row + t * (row2 - row)));
    const auto point = static_cast<std::int32_t>(std::ssize(out_.points)) - 1;
    spread_.offer(col, row, point);
    spread_.offer(col2, row2, point);
  }

  const raster::Raster& values_;
  Contour out_;
  Away away_{*this};
  Spread<Away> spread_;
};

}  // namespace

Contour trace_contour(const raster::Raster& values) {
  return Tracer(values).run();
}

}  // namespace tafoni::terrain::impl
