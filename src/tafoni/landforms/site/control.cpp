// A region's weight as a field. Each part (box, polygon, mask) is a factor with a range over any box, so that
// the product is exactly 0, and known to be, wherever one part is; masks keep a coarse raster of the least
// and greatest value of each tile for that.

#include "tafoni/landforms/site/control.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/lattice.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

/// The weight at a distance inside a limit; the distance is negative outside.
double rise(double inside, double fade) {
  if (!(inside >= 0)) return 0;
  return fade > 0 ? smoothstep(0.0, fade, inside) : 1;
}

class BoxControl final : public Control {
 public:
  BoxControl(const Box3d& box, double fade) : box_(box), fade_(fade) {}
  double at(Vec3d p) const override {
    return rise(std::min({p.x - box_.lo.x, box_.hi.x - p.x, p.y - box_.lo.y, box_.hi.y - p.y, p.z - box_.lo.z,
                          box_.hi.z - p.z}),
                fade_);
  }
  Range over(const Box3d& box) const override {
    // The least of one distance for each axis: their extremes are taken independently.
    const auto axis = [](double lo, double hi, double from, double to) {
      const double middle = std::isfinite(lo) && std::isfinite(hi) ? 0.5 * (lo + hi)
                            : std::isfinite(lo)                    ? to
                                                                   : from;
      const double best = std::clamp(middle, from, to);
      return Range{std::min(from - lo, hi - to), std::min(best - lo, hi - best)};
    };
    const Range x = axis(box_.lo.x, box_.hi.x, box.lo.x, box.hi.x);
    const Range y = axis(box_.lo.y, box_.hi.y, box.lo.y, box.hi.y);
    const Range z = axis(box_.lo.z, box_.hi.z, box.lo.z, box.hi.z);
    return {rise(std::min({x.lo, y.lo, z.lo}), fade_), rise(std::min({x.hi, y.hi, z.hi}), fade_)};
  }

 private:
  Box3d box_;
  double fade_;
};

class OutlineControl final : public Control {
 public:
  OutlineControl(std::shared_ptr<const Outline> outline, double fade)
      : outline_(std::move(outline)), fade_(fade) {}
  double at(Vec3d p) const override {
    if (!outline_->inside({p.x, p.y})) return 0;
    return fade_ > 0 ? rise(outline_->distance({p.x, p.y}, fade_), fade_) : 1;
  }
  /// The distance at the box's centre tells: elsewhere in the box it differs by no more than one goes.
  Range over(const Box3d& box) const override {
    const Vec3d c = box.center();
    const double around = 0.5 * std::hypot(box.hi.x - box.lo.x, box.hi.y - box.lo.y);
    const double most = fade_ + 2 * around + 1;
    const double d = outline_->distance({c.x, c.y}, most);
    if (d > around) {
      if (!outline_->inside({c.x, c.y})) return {0, 0};
      return {rise(d - around, fade_), rise(d + around, fade_)};
    }
    return {0, rise(d + around, fade_)};
  }

 private:
  std::shared_ptr<const Outline> outline_;
  double fade_;
};

constexpr int tile_side = 16;  // pixels a side

void include(Range& range, double value) {
  range = {std::min(range.lo, value), std::max(range.hi, value)};
}

double mix(float a, float b, double t) {
  return a + (double{b} - a) * t;
}

int pixel(double at, int count) {
  return floor_to(std::clamp(at, 0.0, count - 1.0));
}

class MaskControl final : public Control {
 public:
  explicit MaskControl(const raster::Raster& mask) : values_(clean(mask), mask.placement) {}
  double at(Vec3d p) const override { return std::clamp(values_.at(p), 0.0, 1.0); }
  Range over(const Box3d& box) const override {
    const Range range = values_.over(box);
    return {std::clamp(range.lo, 0.0, 1.0), std::clamp(range.hi, 0.0, 1.0)};
  }

 private:
  static raster::Grid<float> clean(const raster::Raster& mask) {
    raster::Grid<float> out = mask.values;
    for (int row = 0; row < out.height(); ++row)
      for (int col = 0; col < out.width(); ++col) {
        if (std::isfinite(mask.values.at(col, row))) continue;
        for (int r = row - 1; r <= row + 1; ++r)
          for (int c = col - 1; c <= col + 1; ++c)
            if (out.inside(c, r))
              out.at(c, r) = out.at(c, r) < 0 && std::isfinite(out.at(c, r)) ? out.at(c, r) : 0;
      }
    return out;
  }

  RangedRaster values_;
};

class Product final : public field::Function {
 public:
  explicit Product(std::vector<ControlPtr> parts) : parts_(std::move(parts)) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      double value = 1;
      for (const ControlPtr& part : parts_) {
        value *= part->at(points[i]);
        if (value == 0) break;
      }
      out[i] = static_cast<float>(value);
    }
  }
  Interval range(const Box3d& box) const override {
    if (!std::isfinite(length(box.size()))) return {0, 1};
    double lo = 1, hi = 1;
    for (const ControlPtr& part : parts_) {
      const Range range = part->over(box);
      lo *= range.lo;
      hi *= range.hi;
      if (hi == 0) return {0, 0};
    }
    // Exact where the field is constant; elsewhere wider than rounding.
    constexpr double slack = 1e-6;
    return rounded(lo == 1 ? 1 : std::max(0.0, lo - slack), std::min(1.0, hi + slack));
  }

 private:
  std::vector<ControlPtr> parts_;
};

}  // namespace

RangedRaster::RangedRaster(raster::Grid<float> values, const raster::Placement& placement)
    : placement_(placement), values_(std::move(values)) {
  const int across = (values_.width() + tile_side - 1) / tile_side,
            down = (values_.height() + tile_side - 1) / tile_side;
  tiles_ = raster::Grid<Range>(across, down, Range{1e300, -1e300});
  for (int row = 0; row < values_.height(); ++row)
    for (int col = 0; col < values_.width(); ++col)
      include(tiles_.at(col / tile_side, row / tile_side), values_.at(col, row));
}

double RangedRaster::at(Vec3d p) const {
  const Vec2d at = placement_.pixel(p.x, p.y);
  const double x = std::clamp(at.x, 0.0, values_.width() - 1.0);
  const double y = std::clamp(at.y, 0.0, values_.height() - 1.0);
  const int col = floor_to(x), row = floor_to(y);
  const int right = std::min(col + 1, values_.width() - 1), below = std::min(row + 1, values_.height() - 1);
  const double u = x - col, v = y - row;
  const double top = mix(values_.at(col, row), values_.at(right, row), u);
  const double bottom = mix(values_.at(col, below), values_.at(right, below), u);
  return top + (bottom - top) * v;
}

Range RangedRaster::over(const Box3d& box) const {
  const Vec2d a = placement_.pixel(box.lo.x, box.hi.y), b = placement_.pixel(box.hi.x, box.lo.y);
  const int left = pixel(std::floor(a.x), values_.width()), right = pixel(std::ceil(b.x), values_.width());
  const int top = pixel(std::floor(a.y), values_.height()), bottom = pixel(std::ceil(b.y), values_.height());
  Range range{1e300, -1e300};
  if (right - left > 2 * tile_side || bottom - top > 2 * tile_side) {
    for (int row = top / tile_side; row <= bottom / tile_side; ++row)
      for (int col = left / tile_side; col <= right / tile_side; ++col) {
        include(range, tiles_.at(col, row).lo);
        include(range, tiles_.at(col, row).hi);
      }
  } else {
    for (int row = top; row <= bottom; ++row)
      for (int col = left; col <= right; ++col) include(range, values_.at(col, row));
  }
  return range;
}

ControlPtr box_control(const Box3d& box, double fade) {
  return std::make_unique<const BoxControl>(box, fade);
}

ControlPtr outline_control(std::shared_ptr<const Outline> outline, double fade) {
  return std::make_unique<const OutlineControl>(std::move(outline), fade);
}

ControlPtr mask_control(const raster::Raster& mask) {
  return std::make_unique<const MaskControl>(mask);
}

field::FunctionPtr product(std::vector<ControlPtr> parts) {
  return std::make_shared<const Product>(std::move(parts));
}

}  // namespace tafoni::landforms::impl
