// Regions: lists of altitude ranges, boxes, polygons and masks, all of which must hold. Their weight at a
// place is the product of the masks' values; as a control field each part also fades in from its own limit.

#include "tafoni/landforms/site/region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tafoni/landforms/site/control.h"
#include "tafoni/landforms/site/outline.h"
#include "tafoni/raster/resample.h"

namespace tafoni::landforms {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool covers(const raster::Raster& mask, Vec3d p) {
  const Vec2d at = mask.placement.pixel(p.x, p.y);
  return at.x >= -0.5 && at.y >= -0.5 && at.x <= mask.width() - 0.5 && at.y <= mask.height() - 0.5;
}

Box3d extent(const raster::Raster& mask) {
  const raster::Placement& at = mask.placement;
  return {{at.west, at.north - at.dy * mask.height(), -infinity},
          {at.west + at.dx * mask.width(), at.north, infinity}};
}

void intersect(Box3d& a, const Box3d& b) {
  a.lo = {std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)};
  a.hi = {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)};
}

}  // namespace

void Region::limit_altitude(double lo, double hi) {
  altitudes_.push_back({lo, hi});
}

void Region::limit_box(const Box3d& box) {
  boxes_.push_back(box);
}

void Region::limit_polygon(const std::vector<Ring>& rings) {
  polygons_.push_back(std::make_shared<const impl::Outline>(rings));
}

void Region::limit_mask(std::shared_ptr<const raster::Raster> mask) {
  masks_.push_back(std::move(mask));
}

double Region::weight(Vec3d p) const {
  for (const Altitude& range : altitudes_)
    if (!(p.z >= range.lo && p.z <= range.hi)) return 0;
  for (const Box3d& box : boxes_)
    if (!box.contains(p)) return 0;
  double weight = 1;
  for (const auto& mask : masks_) {
    if (!covers(*mask, p)) return 0;
    const double value = raster::sample_bilinear(*mask, p.x, p.y);
    if (!(value > 0)) return 0;
    weight *= std::min(value, 1.0);
  }
  for (const auto& outline : polygons_)
    if (!outline->inside({p.x, p.y})) return 0;
  return weight;
}

Box3d Region::bounds() const {
  Box3d all{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
  for (const Altitude& range : altitudes_) {
    all.lo.z = std::max(all.lo.z, range.lo);
    all.hi.z = std::min(all.hi.z, range.hi);
  }
  for (const Box3d& box : boxes_) intersect(all, box);
  for (const auto& mask : masks_) intersect(all, extent(*mask));
  for (const auto& outline : polygons_) {
    const Box3d box = outline->bounds();
    if (box.empty()) return {};
    intersect(all, {{box.lo.x, box.lo.y, -infinity}, {box.hi.x, box.hi.y, infinity}});
  }
  return all;
}

field::FunctionPtr as_function(const Region* region, double fade) {
  if (!region) return nullptr;
  std::vector<impl::ControlPtr> parts;
  for (const Region::Altitude& range : region->altitudes_)
    parts.push_back(
        impl::box_control({{-infinity, -infinity, range.lo}, {infinity, infinity, range.hi}}, fade));
  for (const Box3d& box : region->boxes_) parts.push_back(impl::box_control(box, fade));
  for (const auto& outline : region->polygons_) parts.push_back(impl::outline_control(outline, fade));
  for (const auto& mask : region->masks_) {
    parts.push_back(impl::mask_control(*mask));
    parts.push_back(impl::box_control(extent(*mask), fade));
  }
  return impl::product(std::move(parts));
}

}  // namespace tafoni::landforms
