// A raster made ready for evaluation: a pyramid of tiles with the least and greatest height and slope, which
// answers for any rectangle, and the falloff sigma that turns distances into values.

#include <algorithm>
#include <cmath>

#include "tafoni/field/impl/leaves.h"
#include "tafoni/math/whole.h"

namespace tafoni::field::impl {
namespace {

/// Pixels along a side of the pyramid's lowest level: less answers more tightly, more takes less memory.
constexpr int tile = 16;

Sampler::Range join(const Sampler::Range& a, const Sampler::Range& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi), std::max(a.slope, b.slope)};
}

}  // namespace

Sigma::Sigma(const HeightfieldSettings& settings)
    : influence(static_cast<float>(settings.influence)), amplitude(static_cast<float>(settings.amplitude)) {
  const double r = settings.influence, t = settings.amplitude;
  if (!(r > 0) || !(t > 0) || !std::isfinite(r) || !std::isfinite(t))
    fail(ErrorKind::usage, "influence and amplitude must be positive lengths in metres");
  if (r > 3 * t)
    fail(ErrorKind::usage,
         "influence = {} m is over three times amplitude = {} m; the field would not be monotone", r, t);
  k2 = static_cast<float>((3 * t - 2 * r) / (r * r));
  k3 = static_cast<float>((r - 2 * t) / (r * r * r));
}

float Sigma::operator()(float x) const {
  const float a = std::fabs(x);
  const float s = a < influence ? a * (1.f + a * (k2 + a * k3)) : amplitude;
  return std::copysign(s, x);
}

Sampler::Sampler(std::shared_ptr<const raster::Raster> raster, bool bicubic)
    : raster_(std::move(raster)),
      bicubic_(bicubic),
      inv_dx_(1 / raster_->placement.dx),
      inv_dy_(1 / raster_->placement.dy),
      slope_x_(static_cast<float>(inv_dx_)),
      slope_y_(static_cast<float>(-inv_dy_)) {
  if (raster_->values.empty()) fail(ErrorKind::input, "the heightfield has no samples");
  build_pyramid();
}

Sampler::Range Sampler::tile_range(int tile_x, int tile_y) const {
  const auto& grid = raster_->values;
  const int x0 = std::max(tile_x * tile - 1, 0), x1 = std::min(tile_x * tile + tile + 2, grid.width() - 1);
  const int y0 = std::max(tile_y * tile - 1, 0), y1 = std::min(tile_y * tile + tile + 2, grid.height() - 1);
  float lo = grid.at(x0, y0), hi = lo, step_x = 0, step_y = 0;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float v = grid.at(x, y);
      lo = std::min(lo, v), hi = std::max(hi, v);
      if (x > x0) step_x = std::max(step_x, std::fabs(v - grid.at(x - 1, y)));
      if (y > y0) step_y = std::max(step_y, std::fabs(v - grid.at(x, y - 1)));
    }
  const float gx = step_x * slope_x_, gy = step_y * slope_y_;
  const float slope = std::sqrt(gx * gx + gy * gy);
  if (!bicubic_) return {lo, hi, slope};
  // Catmull-Rom's negative weights sum to at most 1/8 a side along one axis, so the plane's overshoot is at
  // most (1.25^2 - 1) / 2 of the range; its slope is at most 1.5 x 1.25 times the steepest step.
  constexpr float overshoot = 0.2813f, steepest = 1.875f;
  const float over = overshoot * (hi - lo);
  return {lo - over, hi + over, steepest * slope};
}

void Sampler::build_pyramid() {
  const int width = (raster_->width() + tile - 1) / tile, height = (raster_->height() + tile - 1) / tile;
  raster::Grid<Range> level(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) level.at(x, y) = tile_range(x, y);
  pyramid_.push_back(std::move(level));
  while (pyramid_.back().size() > 1) {
    const auto& below = pyramid_.back();
    raster::Grid<Range> next((below.width() + 1) / 2, (below.height() + 1) / 2);
    for (int y = 0; y < next.height(); ++y)
      for (int x = 0; x < next.width(); ++x) {
        Range r = below.at(2 * x, 2 * y);
        const int x1 = std::min(2 * x + 1, below.width() - 1), y1 = std::min(2 * y + 1, below.height() - 1);
        r = join(join(r, below.at(x1, 2 * y)), join(below.at(2 * x, y1), below.at(x1, y1)));
        next.at(x, y) = r;
      }
    pyramid_.push_back(std::move(next));
  }
  top_ = pyramid_.back().at(0, 0);
}

Sampler::Range Sampler::range(double x0, double y0, double x1, double y1) const {
  const auto clamp_pixel = [](double pixel, int size) {
    return floor_to(std::clamp(pixel, 0.0, size - 1.0));
  };
  const auto& place = raster_->placement;
  // One pixel of slack covers rounding.
  int c0 = clamp_pixel((x0 - place.west) * inv_dx_ - 1.5, raster_->width()) / tile;
  int c1 = clamp_pixel((x1 - place.west) * inv_dx_ + 0.5, raster_->width()) / tile;
  int r0 = clamp_pixel((place.north - y1) * inv_dy_ - 1.5, raster_->height()) / tile;
  int r1 = clamp_pixel((place.north - y0) * inv_dy_ + 0.5, raster_->height()) / tile;
  std::size_t level = 0;
  while (level + 1 < pyramid_.size() && (c1 - c0 > 3 || r1 - r0 > 3)) {
    c0 /= 2, c1 /= 2, r0 /= 2, r1 /= 2;
    ++level;
  }
  Range r = pyramid_[level].at(c0, r0);
  for (int y = r0; y <= r1; ++y)
    for (int x = c0; x <= c1; ++x) r = join(r, pyramid_[level].at(x, y));
  return r;
}

void Axis::set(std::int64_t first, double voxel, double origin) {
  for (int i = 0; i < size; ++i) {
    metres[i] = origin + static_cast<double>(first + i) * voxel;
    const Fixed f = to_fixed(metres[i]);
    units[i] = f.units;
    rest[i] = f.rest;
  }
}

}  // namespace tafoni::field::impl
