#include "tafoni/landforms/region.h"

#include <algorithm>
#include <cmath>

#include "tafoni/raster/resample.h"

namespace tafoni::landforms {
namespace {

bool inside(const std::vector<Ring>& rings, double x, double y) {
  bool in = false;
  for (const Ring& ring : rings)
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const Vec2d &a = ring[i], &b = ring[j];
      if ((a.y > y) != (b.y > y) && x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
    }
  return in;
}

}  // namespace

void Region::limit_altitude(double lo, double hi) {
  altitudes_.push_back({lo, hi});
}

void Region::limit_box(const Box3d& box) {
  boxes_.push_back(box);
}

void Region::limit_polygon(std::vector<Ring> rings) {
  polygons_.push_back(std::move(rings));
}

void Region::limit_mask(std::shared_ptr<const raster::Raster> mask) {
  masks_.push_back(std::move(mask));
}

double Region::weight(Vec3d p) const {
  for (const Altitude& a : altitudes_)
    if (p.z < a.lo || p.z > a.hi) return 0;
  for (const Box3d& box : boxes_)
    if (!box.contains(p)) return 0;
  for (const auto& rings : polygons_)
    if (!inside(rings, p.x, p.y)) return 0;
  double weight = 1;
  for (const auto& mask : masks_) {
    const Vec2d q = mask->placement.pixel(p.x, p.y);
    if (q.x < -0.5 || q.y < -0.5 || q.x > mask->width() - 0.5 || q.y > mask->height() - 0.5) return 0;
    const double v = raster::sample_bilinear(*mask, p.x, p.y);
    weight *= std::isfinite(v) ? std::clamp(v, 0.0, 1.0) : 0.0;
  }
  return weight;
}

Box3d Region::bounds() const {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box3d box{{-inf, -inf, -inf}, {inf, inf, inf}};
  const auto cut = [&](const Box3d& by) {
    box.lo = {std::max(box.lo.x, by.lo.x), std::max(box.lo.y, by.lo.y), std::max(box.lo.z, by.lo.z)};
    box.hi = {std::min(box.hi.x, by.hi.x), std::min(box.hi.y, by.hi.y), std::min(box.hi.z, by.hi.z)};
  };
  for (const Altitude& a : altitudes_) cut({{-inf, -inf, a.lo}, {inf, inf, a.hi}});
  for (const Box3d& b : boxes_) cut(b);
  for (const auto& rings : polygons_) {
    Box3d hull;
    for (const Ring& ring : rings)
      for (const Vec2d& p : ring) hull.expand(Vec3d{p.x, p.y, 0});
    hull.lo.z = -inf, hull.hi.z = inf;
    cut(hull);
  }
  for (const auto& mask : masks_) {
    const auto& p = mask->placement;
    cut(Box3d{{p.west, p.north - mask->height() * p.dy, -inf},
              {p.west + mask->width() * p.dx, p.north, inf}});
  }
  return box;
}

}  // namespace tafoni::landforms
