#include "tafoni/terrain/impl/contour.h"

#include <limits>

namespace tafoni::terrain::impl {
namespace {

double squared(Vec2d a) {
  return a.x * a.x + a.y * a.y;
}

class Tracer {
 public:
  explicit Tracer(const raster::Raster& values) : values_(values) {
    out_.nearest = raster::Grid<std::int32_t>(values.width(), values.height(), -1);
  }

  Contour run() {
    const int width = values_.width(), height = values_.height();
    for (int row = 0; row < height; ++row)
      for (int col = 0; col < width; ++col) {
        if (col + 1 < width) cross(col, row, col + 1, row);
        if (row + 1 < height) cross(col, row, col, row + 1);
      }
    for (int row = 0; row < height; ++row) sweep(row, -1);
    for (int row = height - 1; row >= 0; --row) sweep(row, 1);
    return std::move(out_);
  }

 private:
  void cross(int col, int row, int col2, int row2) {
    const double a = static_cast<double>(values_.values.at(col, row));
    const double b = static_cast<double>(values_.values.at(col2, row2));
    if ((a > 0) == (b > 0)) return;
    const double t = a / (a - b);
    out_.points.push_back(values_.placement.center(col + t * (col2 - col), row + t * (row2 - row)));
    const auto point = static_cast<std::int32_t>(out_.points.size() - 1);
    offer(col, row, point);
    offer(col2, row2, point);
  }

  void offer(int col, int row, std::int32_t point) {
    if (point < 0) return;
    std::int32_t& mine = out_.nearest.at(col, row);
    if (mine < 0 || away(col, row, point) < away(col, row, mine)) mine = point;
  }

  double away(int col, int row, std::int32_t point) const {
    return squared(out_.points[static_cast<std::size_t>(point)] - values_.placement.center(col, row));
  }

  /// Takes what the row at `from` knows, then passes it along in both directions.
  void sweep(int row, int from) {
    const int width = values_.width();
    const auto take = [&](int col, int dc, int dr) {
      if (out_.nearest.inside(col + dc, row + dr)) offer(col, row, out_.nearest.at(col + dc, row + dr));
    };
    for (int col = 0; col < width; ++col) {
      take(col, -1, from);
      take(col, 0, from);
      take(col, 1, from);
      take(col, -1, 0);
    }
    for (int col = width - 1; col >= 0; --col) take(col, 1, 0);
  }

  const raster::Raster& values_;
  Contour out_;
};

}  // namespace

Contour trace_contour(const raster::Raster& values) {
  return Tracer(values).run();
}

}  // namespace tafoni::terrain::impl
