#pragma once
// 2D grids and georeferenced rasters. Row 0 is the NORTH edge; a value belongs to the centre of its pixel;
// NaN means no data.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::raster {

template <class T>
class Grid {
 public:
  Grid() = default;
  Grid(int width, int height, T fill = T{})
      : width_(width), height_(height), data_(static_cast<std::size_t>(width) * height, fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return data_.size(); }
  bool empty() const { return data_.empty(); }
  bool inside(int col, int row) const { return col >= 0 && row >= 0 && col < width_ && row < height_; }
  T& at(int col, int row) { return data_[index(col, row)]; }
  const T& at(int col, int row) const { return data_[index(col, row)]; }
  std::size_t index(int col, int row) const { return static_cast<std::size_t>(row) * width_ + col; }
  T* data() { return data_.data(); }
  const T* data() const { return data_.data(); }
  T* row(int r) { return data_.data() + index(0, r); }
  const T* row(int r) const { return data_.data() + index(0, r); }
  std::vector<T>& values() { return data_; }
  const std::vector<T>& values() const { return data_; }

 private:
  int width_ = 0, height_ = 0;
  std::vector<T> data_;
};

/// North-up placement of a grid in a metric CRS: the outer north-west corner and the pixel size, metres.
struct Placement {
  double west = 0, north = 0;
  double dx = 1, dy = 1;  ///< both positive; rows go south

  Vec2d center(double col, double row) const { return {west + (col + 0.5) * dx, north - (row + 0.5) * dy}; }
  /// Continuous pixel coordinates: (0,0) is the centre of the north-west pixel.
  Vec2d pixel(double x, double y) const { return {(x - west) / dx - 0.5, (north - y) / dy - 0.5}; }
};

/// Elevations in metres, as terrain code takes them: metric, north-up, finite or NaN.
struct Raster {
  Grid<float> values;
  Placement placement;
  std::string crs;  ///< WKT; empty when unknown

  int width() const { return values.width(); }
  int height() const { return values.height(); }
  /// The elevation of a pixel, ready to compute with in double.
  double at(int col, int row) const { return values.at(col, row); }
};

inline constexpr float no_data = std::numeric_limits<float>::quiet_NaN();

}  // namespace tafoni::raster
