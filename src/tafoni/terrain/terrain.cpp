// From an elevation model to a terrain: where its origin is, which part of it is the domain, how high its
// box.

#include "tafoni/terrain/terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tafoni/core/error.h"
#include "tafoni/raster/fill.h"
#include "tafoni/terrain/impl/domain.h"

namespace tafoni::terrain {
namespace {

using raster::Grid;
using raster::Raster;

struct Range {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
};

Range range_of(const Grid<float>& values) {
  Range out;
  for (const float v : values.values()) {
    if (std::isnan(v)) continue;
    out.lo = std::min<double>(out.lo, v);
    out.hi = std::max<double>(out.hi, v);
  }
  return out;
}

double multiple_near(double v, double voxel) {
  return std::round(v / voxel) * voxel;
}

/// The rectangle of the domain in x and y: pixels with an inside, and one more where the border runs between
/// pixel centres, cut at the raster's outer border.
Box3d footprint(const Grid<float>& inside, const raster::Placement& p, int width, int height) {
  int left = 0, top = 0, right = width - 1, bottom = height - 1;
  if (!inside.empty()) {
    std::swap(left, right);
    std::swap(top, bottom);
    for (int row = 0; row < height; ++row)
      for (int col = 0; col < width; ++col) {
        if (inside.at(col, row) <= 0) continue;
        left = std::min(left, col);
        right = std::max(right, col);
        top = std::min(top, row);
        bottom = std::max(bottom, row);
      }
    left = std::max(left - 1, 0);
    top = std::max(top - 1, 0);
    right = std::min(right + 1, width - 1);
    bottom = std::min(bottom + 1, height - 1);
  }
  return {{p.west + left * p.dx, p.north - (bottom + 1) * p.dy, 0},
          {p.west + (right + 1) * p.dx, p.north - top * p.dy, 0}};
}

}  // namespace

Terrain make_terrain(const Raster& world, double voxel, const TerrainOptions& options, Progress& progress) {
  const field::HeightfieldSettings& settings = options.settings;
  if (!(voxel > 0) || !std::isfinite(voxel))
    fail(ErrorKind::usage, "the voxel size must be a positive number of metres, not {}.", voxel);
  if (!(settings.influence > 0) || !(settings.influence <= 3 * settings.amplitude))
    fail(ErrorKind::usage,
         "influence R = {} m must be positive and at most three times the amplitude T = {} m.",
         settings.influence, settings.amplitude);
  const Range range = range_of(world.values);
  if (!(range.lo <= range.hi)) fail(ErrorKind::input, "the elevation model holds no data at all.");
  // The field is constant beyond R; a little more keeps interpolation exact up to there.
  const double band = settings.influence + 2 * std::hypot(world.placement.dx, world.placement.dy);
  Grid<float> inside = impl::domain_distance(world, options.polygons, band, progress);
  if (!inside.empty() &&
      std::none_of(inside.values().begin(), inside.values().end(), [](float d) { return d > 0; }))
    fail(ErrorKind::input,
         "the domain's polygon does not cover any of the elevation model's data; check its coordinates.");

  const raster::Placement& p = world.placement;
  Terrain out;
  out.origin = {multiple_near(p.west + world.width() * p.dx / 2, voxel),
                multiple_near(p.north - world.height() * p.dy / 2, voxel),
                multiple_near((range.lo + range.hi) / 2, voxel)};
  const raster::Placement local{p.west - out.origin.x, p.north - out.origin.y, p.dx, p.dy};

  auto heights = std::make_shared<Raster>(Raster{world.values, local, world.crs});
  for (float& h : heights->values.values()) h = static_cast<float>(h - out.origin.z);
  raster::fill_all(*heights, progress);
  out.box = footprint(inside, local, world.width(), world.height());
  const double reach = settings.influence + voxel;
  out.box.lo.z = std::floor((range.lo - out.origin.z - reach - options.depth) / voxel) * voxel;
  out.box.hi.z = std::ceil((range.hi - out.origin.z + reach) / voxel) * voxel;
  out.heights = std::move(heights);

  if (!inside.empty()) {
    auto valid = std::make_shared<Grid<std::uint8_t>>(world.width(), world.height());
    for (std::size_t i = 0; i < inside.size(); ++i) valid->values()[i] = inside.values()[i] > 0;
    out.valid = std::move(valid);
    out.inside = std::make_shared<Raster>(Raster{std::move(inside), local, world.crs});
  }
  return out;
}

field::NodePtr domain_tree(const Terrain& terrain, const field::HeightfieldSettings& settings) {
  return field::domain({terrain.box, terrain.inside}, settings);
}

field::NodePtr terrain_tree(const Terrain& terrain, const field::HeightfieldSettings& settings) {
  return field::intersect({field::heightfield(terrain.heights, settings), domain_tree(terrain, settings)});
}

}  // namespace tafoni::terrain
