// The site as its generators see it: the box in which they may act, from the raster's outline, the surface's
// heights and the region's limits; and whether a place lies on real data, off the border and in the region.

#include "tafoni/landforms/site/ground.h"

#include <algorithm>
#include <limits>

#include "tafoni/math/whole.h"
#include "tafoni/raster/resample.h"

namespace tafoni::landforms::impl {
namespace {

Box3d outline_of(const Site& site) {
  const raster::Raster& heights = *site.heights;
  const raster::Placement& at = heights.placement;
  const auto [lo, hi] = std::minmax_element(heights.values.values().begin(), heights.values.values().end());
  // Earlier layers may have put rock above the heights: islands, towers.
  const Box3d surface = field::compile(site.terrain).bounds();
  return {
      {at.west, at.north - at.dy * heights.height(), std::min(surface.lo.z, double{*lo}) - site.influence},
      {at.west + at.dx * heights.width(), at.north, std::max(surface.hi.z, double{*hi}) + site.influence}};
}

}  // namespace

Ground::Ground(const Site& site)
    : site_(site),
      outline_(outline_of(site)),
      box_(outline_),
      pixel_(std::max(site.heights->placement.dx, site.heights->placement.dy)) {
  if (!site.region) return;
  const Box3d limit = site.region->bounds();
  box_.lo = {std::max(box_.lo.x, limit.lo.x), std::max(box_.lo.y, limit.lo.y),
             std::max(box_.lo.z, limit.lo.z)};
  box_.hi = {std::min(box_.hi.x, limit.hi.x), std::min(box_.hi.y, limit.hi.y),
             std::min(box_.hi.z, limit.hi.z)};
}

bool Ground::on_data(double x, double y) const {
  if (x < outline_.lo.x || x > outline_.hi.x || y < outline_.lo.y || y > outline_.hi.y) return false;
  if (!site_.valid) return true;
  const Vec2d at = site_.heights->placement.pixel(x, y);
  return site_.valid->at(std::clamp(round_to(at.x), 0, site_.valid->width() - 1),
                         std::clamp(round_to(at.y), 0, site_.valid->height() - 1)) != 0;
}

bool Ground::usable(Vec3d p) const {
  return on_data(p.x, p.y) && (!site_.region || site_.region->contains(p));
}

bool Ground::usable(Vec3d p, double margin) const {
  if (!usable(p)) return false;
  const double diagonal = margin * 0.7071;
  for (const Vec2d d : {Vec2d{margin, 0},
                        {-margin, 0},
                        {0, margin},
                        {0, -margin},
                        {diagonal, diagonal},
                        {-diagonal, diagonal},
                        {diagonal, -diagonal},
                        {-diagonal, -diagonal}})
    if (!on_data(p.x + d.x, p.y + d.y)) return false;
  return true;
}

double Ground::weight(Vec3d p) const {
  return site_.region ? site_.region->weight(p) : 1;
}

double Ground::resistance(Vec3d p) const {
  return site_.geology ? site_.geology->resistance(p) : 0.5;
}

void Ground::resistances(std::span<const Vec3d> points, std::span<float> out) const {
  if (site_.geology)
    site_.geology->resistances(points, out);
  else
    std::fill(out.begin(), out.end(), 0.5f);
}

double Ground::height(double x, double y) const {
  return raster::sample_bilinear(*site_.heights, x, y);
}

field::FunctionPtr control_of(const Site& site, double fade) {
  if (!site.valid) return as_function(site.region, fade);
  Region region = site.region ? *site.region : Region();
  auto mask = std::make_shared<raster::Raster>(*site.heights);
  for (std::size_t i = 0; i < mask->values.size(); ++i)
    mask->values.values()[i] = site.valid->values()[i] ? 1.0f : std::numeric_limits<float>::quiet_NaN();
  region.limit_mask(std::move(mask));
  return as_function(&region, fade);
}

}  // namespace tafoni::landforms::impl
