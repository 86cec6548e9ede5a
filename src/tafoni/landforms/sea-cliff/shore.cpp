// The sea's reach as two rasters, read at the nearest pixel: the signed distance to open water, and the
// accessibility of the strip of ground that the sea can reach, each pixel the best of its neighbours.

#include "tafoni/landforms/sea-cliff/shore.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/distance.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms::impl {
namespace {

/// Chosen by eye.
namespace shore_look {
// The best accessibility within this share of its radius counts, so that the foot of a straight cliff is no
// sheltered nook; in pixels so many at most, for the work grows with their square.
constexpr double lee = 0.25;
constexpr int lee_pixels = 6;
// The share of the reach from which the sea's effect falls off.
constexpr double full_reach = 0.6;
}  // namespace shore_look

/// The value of the pixel nearest to a place.
float nearest(const raster::Raster& raster, Vec3d p) {
  const Vec2d at = raster.placement.pixel(p.x, p.y);
  return raster.values.at(std::clamp(round_to(at.x), 0, raster.width() - 1),
                          std::clamp(round_to(at.y), 0, raster.height() - 1));
}

}  // namespace

Shore::Shore(const Ground& ground, const ShoreSettings& settings, double sea_z, Progress& progress)
    : ground_(ground), s_(settings), water_(water_distance(sea_z, progress)), open_(exposure(progress)) {}

/// Accessibility [Miller94], the best within a few metres.
raster::Raster Shore::exposure(Progress& progress) const {
  const raster::Raster& heights = *ground_.site().heights;
  raster::Raster open;
  open.placement = heights.placement;
  if (s_.accessibility <= 0) return open;
  const int reach = std::clamp(round_to(shore_look::lee * s_.accessibility_radius / ground_.pixel()), 0,
                               shore_look::lee_pixels);
  const auto wanted = strip(reach + 2);
  const auto grid = terrain::accessibility(heights, {s_.accessibility_radius, &wanted}, progress);
  open.values = raster::Grid<float>(grid.width(), grid.height());
  parallel_blocks(grid.height(), 16, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int col = 0; col < grid.width(); ++col) {
        float best = 0;
        for (int r = std::max(0, row - reach); r <= std::min(grid.height() - 1, row + reach); ++r)
          for (int c = std::max(0, col - reach); c <= std::min(grid.width() - 1, col + reach); ++c)
            if (wanted.at(c, r)) best = std::max(best, grid.at(c, r));
        open.values.at(col, row) = best;
      }
  });
  return open;
}

/// Where the sea can act, and `more` pixels around it.
raster::Grid<std::uint8_t> Shore::strip(int more) const {
  const raster::Grid<float>& heights = ground_.site().heights->values;
  raster::Grid<std::uint8_t> out(heights.width(), heights.height(), 1);
  if (water_.values.empty()) return out;
  const auto limit = static_cast<float>(s_.reach + more * ground_.pixel());
  for (std::size_t i = 0; i < out.size(); ++i) out.values()[i] = std::abs(water_.values.values()[i]) <= limit;
  return out;
}

/// Metres to open water: ground below the sea level, or none at all where there is no data. Empty when
/// there is no water, and then the sea acts on all there is in its range.
raster::Raster Shore::water_distance(double sea_z, Progress& progress) const {
  const raster::Raster& heights = *ground_.site().heights;
  raster::Grid<std::uint8_t> land(heights.width(), heights.height(), 1);
  bool any = false;
  for (int row = 0; row < heights.height(); ++row)
    for (int col = 0; col < heights.width(); ++col)
      if (heights.values.at(col, row) < sea_z ||
          (ground_.site().valid && !ground_.site().valid->at(col, row))) {
        land.at(col, row) = 0;
        any = true;
      }
  raster::Raster distance;
  distance.placement = heights.placement;
  if (any)
    distance.values = raster::signed_distance(land, distance.placement.dx, distance.placement.dy, progress);
  return distance;
}

double Shore::accessibility(Vec3d p) const {
  return open_.values.empty() ? 1 : 1 - s_.accessibility * (1 - nearest(open_, p));
}

double Shore::nearness(Vec3d p) const {
  return water_.values.empty() ? 1
                               : 1 - smoothstep(shore_look::full_reach * s_.reach, s_.reach,
                                                double{std::abs(nearest(water_, p))});
}

bool Shore::may_reach(Vec3d p, double around) const {
  return water_.values.empty() || std::abs(nearest(water_, p)) < s_.reach + around + 2 * ground_.pixel();
}

}  // namespace tafoni::landforms::impl
