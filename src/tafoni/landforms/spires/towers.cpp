// A block is a prism with cut corners whose width falls by steps; a tower is the union of its blocks. Cells
// of a grid in plan hold the towers near them, so that a point looks at few.

#include "tafoni/landforms/spires/towers.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

constexpr double far_away = -1e6;

// Chosen by eye.
constexpr double flare_height = 0.14, flare = 0.22;  // of a block's height, and how much broader its foot is
constexpr double top_slope = 0.9;  // keeps a tilted top's distance from being more than it is

/// The share of the extents at a height: steps, and broader where it stands on the ground.
double share(const Block& block, double h) {
  const double u = std::clamp(h / block.top, 0.0, 1.0) * static_cast<double>(block.widths.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(u), block.widths.size() - 2);
  // Two thirds of each storey rise straight, the rest draws in.
  const double t = std::clamp(3 * (u - static_cast<double>(i)) - 2, 0.0, 1.0);
  const double w = block.widths[i] + (block.widths[i + 1] - block.widths[i]) * t;
  const double low = std::clamp(1 - h / (flare_height * block.top), 0.0, 2.0);
  return w * (1 + flare * low * low);
}

struct Frame {
  Vec2d u, v;
  explicit Frame(const Block& b) : u{std::cos(b.turn), std::sin(b.turn)}, v{-u.y, u.x} {}
};

double block_body(const Block& b, Vec3d p, double foot) {
  const double h = p.z - foot, k = share(b, h);
  const Frame f(b);
  const Vec2d d{p.x - b.at.x - b.lean.x * h, p.y - b.at.y - b.lean.y * h};
  const double x = std::abs(d.x * f.u.x + d.y * f.u.y), y = std::abs(d.x * f.v.x + d.y * f.v.y);
  const double corner = ((b.half.x + b.half.y) * k - b.cut - x - y) * 0.7071;
  const double side = std::min({b.half.x * k - x, b.half.y * k - y, corner});
  return std::min(side, (b.top - h + b.tilt.x * d.x + b.tilt.y * d.y) * top_slope);
}

}  // namespace

Towers::Towers(std::vector<Tower> towers, const RockTexture& texture)
    : RockShape(texture), towers_(std::move(towers)) {
  double widest = 1;
  for (const Tower& tower : towers_) {
    reaches_.push_back(reach(tower));
    box_.expand(reaches_.back());
    widest = std::max(widest, reaches_.back().size().x);
  }
  cell_ = std::max(widest, std::max(box_.size().x, box_.size().y) / 512);
  columns_ = floor_to(box_.size().x / cell_) + 1;
  rows_ = floor_to(box_.size().y / cell_) + 1;
  cells_.resize(std::size_t{1} * columns_ * rows_);
  for (std::uint32_t i = 0; i < towers_.size(); ++i) {
    const auto [c0, c1, r0, r1] = cells(reaches_[i]);
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) cells_[r * columns_ + c].towers.push_back(i);
  }
}

Box3d Towers::reach(const Tower& tower) const {
  Box3d box;
  for (const Block& b : tower.blocks) {
    // The foot's flare goes on below the ground.
    const double r = 1.9 * std::hypot(b.half.x, b.half.y) + 0.05 * (b.top + tower.sunk);
    const double high = tower.foot.z + b.top + 0.5 * r;
    box.expand(Vec3d{b.at.x - r, b.at.y - r, tower.foot.z - tower.sunk});
    box.expand(Vec3d{b.at.x + r, b.at.y + r, high});
  }
  return box.grown(texture().amplitude * 1.2 + margin());
}

std::array<int, 4> Towers::cells(const Box3d& box) const {
  const auto at = [this](double v, double lo, int n) {
    return floor_to(std::clamp((v - lo) / cell_, 0.0, n - 1.0));
  };
  return {at(box.lo.x, box_.lo.x, columns_), at(box.hi.x, box_.lo.x, columns_),
          at(box.lo.y, box_.lo.y, rows_), at(box.hi.y, box_.lo.y, rows_)};
}

double Towers::body(Vec3d p) const {
  if (!box_.contains(p)) return far_away;
  const auto [c, c1, r, r1] = cells({p, p});
  double most = far_away;
  for (std::uint32_t i : cells_[r * columns_ + c].towers) {
    if (!reaches_[i].contains(p)) continue;
    const Tower& tower = towers_[i];
    const double below = p.z - (tower.foot.z - tower.sunk);
    for (const Block& block : tower.blocks)
      most = std::max(most, std::min(below, block_body(block, p, tower.foot.z)));
  }
  return most;
}

RockShape::Range Towers::body_range(const Box3d& box) const {
  Range range{far_away, far_away};
  if (!box.overlaps(box_)) return range;
  const auto [c0, c1, r0, r1] = cells(box);
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c)
      for (std::uint32_t i : cells_[r * columns_ + c].towers) {
        if (!reaches_[i].overlaps(box)) continue;
        const Tower& tower = towers_[i];
        for (const Block& b : tower.blocks) {
          // Shares fall with height, so the ends of the box bound them; the rest moves by at most the slope.
          const double h0 = box.lo.z - tower.foot.z, h1 = box.hi.z - tower.foot.z;
          const double wide = share(b, h0), slim = share(b, h1);
          const Vec3d half = 0.5 * box.size(), middle = box.center();
          const Frame f(b);
          const double h = middle.z - tower.foot.z;
          const Vec2d d{middle.x - b.at.x - b.lean.x * h, middle.y - b.at.y - b.lean.y * h};
          const Vec2d slack{half.x + std::abs(b.lean.x) * half.z, half.y + std::abs(b.lean.y) * half.z};
          const double rx = std::abs(f.u.x) * slack.x + std::abs(f.u.y) * slack.y;
          const double ry = std::abs(f.v.x) * slack.x + std::abs(f.v.y) * slack.y;
          const double x = std::abs(d.x * f.u.x + d.y * f.u.y), y = std::abs(d.x * f.v.x + d.y * f.v.y);
          const double lift = std::abs(b.tilt.x) * slack.x + std::abs(b.tilt.y) * slack.y;
          const double top = b.top + b.tilt.x * d.x + b.tilt.y * d.y;
          const auto bound = [&](double k, double sign, double low, double below) {
            const double corner = ((b.half.x + b.half.y) * k - b.cut - x - y + sign * (rx + ry)) * 0.7071;
            return std::min({b.half.x * k - x + sign * rx, b.half.y * k - y + sign * ry, corner,
                             (top - low + sign * lift) * top_slope, below});
          };
          const double sole = tower.foot.z - tower.sunk;
          range.hi = std::max(range.hi, bound(wide, 1, h0, box.hi.z - sole));
          range.lo = std::max(range.lo, bound(slim, -1, h1, box.lo.z - sole));
        }
      }
  return range;
}

}  // namespace tafoni::landforms::impl
