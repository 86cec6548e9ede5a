// The chance of a pillar is a product: of slope, of standing above what lies around, of groups by noise, and
// of keeping out of gullies and near rivers. Darts are thrown in rounds at the cells of a grid, which decides
// in an order that does not depend on threads.

#include "tafoni/landforms/hoodoos/stands.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/distance.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms::impl {
namespace {

enum class StandsStream : std::uint64_t { stands = 0x70 };
/// Of the stands' own seed.
enum class Sub : std::uint64_t { clusters = 0xc1, darts = 0x5ead };

// Chosen by eye.
constexpr double spacing_in_radii = 3, across_in_radii = 3, margin_in_radii = 2.5;
constexpr double least_catchment = 120, catchment_in_pixels = 12;  // metres; a rill of a coarse DEM is wider
constexpr double flow_exponent = 1.1;                 // how drainage parts among lower neighbours
constexpr double soft_from = 0.7, soft_degrees = 10;  // slopes fade in over this share, out over so many
constexpr double brink_from = 1.2, brink_to = 1.8;  // falls beside a place, as slopes: it is a cliff's brink
constexpr double hollow = -0.05, crest = 0.12;      // heights over what lies around, in slope widths
constexpr double group_in_spacings = 8;             // wavelength of groups
constexpr double group_from = 0.42, group_to = 0.58;  // noise outside of groups and within them
constexpr double gully_reach = 0.2;                   // of the slope width: a gully so near counts
constexpr double bank_from = 0.3;                     // of the margin: nearer to a river none stand
constexpr double river_from = 0.6;                    // of the distance to rivers: from here they get fewer

/// Darts thrown at each cell of the Poisson-disk grid; fewer on large terrains.
constexpr std::int64_t fewest_rounds = 4, most_rounds = 24, most_darts = 4'000'000;
/// Cells of that grid, each with a dart: a third of a gigabyte.
constexpr double most_cells = 1e7;

float nearest(const raster::Grid<float>& grid, double col, double row) {
  return grid.at(std::clamp(round_to(col), 0, grid.width() - 1),
                 std::clamp(round_to(row), 0, grid.height() - 1));
}

}  // namespace

Stands::Stands(const Ground& ground, const StandSettings& settings, double radius, Progress& progress)
    : ground_(ground),
      settings_(settings),
      across_(across_in_radii * radius),
      margin_(margin_in_radii * radius),
      seed_(hash_combine(ground.site().seed, StandsStream::stands)) {
  if (!(settings.spacing > 0)) settings_.spacing = spacing_in_radii * radius;
  if (!(settings.catchment > 0))
    settings_.catchment = std::max(least_catchment, catchment_in_pixels * ground.pixel());
  const raster::Raster& heights = *ground.site().heights;
  raster::Raster filled = heights;
  filled.values = terrain::fill_depressions(heights, {}, progress);
  catchment_ = terrain::drainage_area(filled, flow_exponent, progress);
  if (settings.river > 0) {
    raster::Grid<std::uint8_t> rivers(heights.width(), heights.height());
    for (std::size_t i = 0; i < rivers.size(); ++i)
      rivers.data()[i] = catchment_.data()[i] >= settings.river_area;
    river_ = raster::signed_distance(rivers, heights.placement.dx, heights.placement.dy, progress);
  }
  const auto across = static_cast<float>(1 / ground.pixel());
  for (float& area : catchment_.values()) area *= across;
}

double Stands::slope(double x, double y) const {
  const double d = 0.5 * across_;
  const double sx = ground_.height(x + d, y) - ground_.height(x - d, y);
  const double sy = ground_.height(x, y + d) - ground_.height(x, y - d);
  return std::hypot(sx, sy) / (2 * d);
}

double Stands::chance(double x, double y) const {
  const Vec3d p{x, y, ground_.height(x, y)};
  if (!ground_.usable(p, margin_)) return 0;
  double chance = chance_by_relief(p);
  if (chance == 0) return 0;
  const Vec2d pixel = ground_.site().heights->placement.pixel(x, y);
  chance *= share_by_gullies(pixel);
  if (!river_.empty()) chance *= share_by_river(pixel);
  return settings_.density * chance * ground_.weight(p);
}

/// On medium slopes, not on the brink of a cliff, rather on a crest than in a hollow, and in groups.
double Stands::chance_by_relief(Vec3d p) const {
  const StandSettings& set = settings_;
  const double s = std::atan(slope(p.x, p.y)) / degree;
  double chance = smoothstep(soft_from * set.slope[0], set.slope[0], s) *
                  (1 - smoothstep(set.slope[1], set.slope[1] + soft_degrees, s));
  if (chance == 0) return 0;
  double lowest = p.z, mean = 0;
  for (int k = 0; k < 8; ++k) {
    const double a = 45 * degree * k;
    const double z = ground_.height(p.x + across_ * std::cos(a), p.y + across_ * std::sin(a));
    lowest = std::min(lowest, z);
    mean += z / 8;
  }
  chance *= 1 - smoothstep(brink_from, brink_to, (p.z - lowest) / across_);
  chance *= 1 - set.ridges * (1 - smoothstep(hollow, crest, (p.z - mean) / across_));
  const double group = 1 / (group_in_spacings * set.spacing);
  const double gathered = fbm({p.x * group, p.y * group, 0.37}, 2, hash_combine(seed_, Sub::clusters));
  chance *= 1 - set.clusters * (1 - smoothstep(group_from, group_to, gathered));
  return chance;
}

/// Where water gathers no pillar is left, nor beside a gully.
double Stands::share_by_gullies(Vec2d pixel) const {
  double most = 0;
  const double aside = gully_reach * across_ / ground_.pixel();
  for (const double dx : {-aside, 0.0, aside})
    for (const double dy : {-aside, 0.0, aside})
      most = std::max(most, double{nearest(catchment_, pixel.x + dx, pixel.y + dy)});
  return 1 - smoothstep(0.5 * settings_.catchment, settings_.catchment, most);
}

double Stands::share_by_river(Vec2d pixel) const {
  const double bank = -nearest(river_, pixel.x, pixel.y);
  return smoothstep(bank_from * margin_, margin_, bank) *
         (1 - smoothstep(river_from * settings_.river, settings_.river, bank));
}

std::vector<Vec3d> Stands::places(const std::vector<Vec3d>& taken) const {
  const Box3d& box = ground_.box();
  if (box.empty()) return {};
  const double cell = settings_.spacing * 0.7071;  // its diagonal is just shorter than the spacing
  const double cells = (box.hi.x - box.lo.x) / cell * ((box.hi.y - box.lo.y) / cell);
  if (!(cells <= most_cells))
    fail(ErrorKind::usage,
         "hoodoos: a spacing of {:g} m over {:.0f} by {:.0f} m leaves room for more than {:.0f} million; "
         "give a "
         "spacing of {:.2g} m or more",
         settings_.spacing, box.hi.x - box.lo.x, box.hi.y - box.lo.y, most_cells / 1e6,
         1.05 * settings_.spacing * std::sqrt(cells / most_cells));
  const auto columns = ceil_to<std::int64_t>((box.hi.x - box.lo.x) / cell);
  const auto rows = ceil_to<std::int64_t>((box.hi.y - box.lo.y) / cell);
  const std::int64_t rounds = std::clamp(most_darts / (columns * rows), fewest_rounds, most_rounds);
  const Random random(seed_, Sub::darts);
  struct Dart {
    Vec3d at;
    double chance;
  };
  // A cell is smaller than the spacing, so it holds one at most.
  std::vector<std::uint8_t> full(columns * rows);
  std::vector<Dart> darts(columns * rows);
  SpatialHash apart(2 * settings_.spacing);
  for (const Vec3d p : taken) apart.insert({p.x, p.y, 0});
  std::vector<std::pair<std::uint64_t, Vec3d>> kept;
  for (std::int64_t round = 0; round < rounds; ++round) {
    const auto number = [&](std::int64_t i, int which) {
      return random.at((i * rounds + round) * 3 + which);
    };
    parallel_blocks(rows, 4, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t i = from * columns; i < to * columns; ++i) {
        darts[i].chance = 0;
        if (full[i] != 0) continue;
        const Vec3d p{box.lo.x + cell * (static_cast<double>(i % columns) + unit_real(number(i, 0))),
                      box.lo.y + cell * (static_cast<double>(i / columns) + unit_real(number(i, 1))), 0};
        darts[i] = {p, chance(p.x, p.y)};
      }
    });
    for (std::int64_t i = 0; i < columns * rows; ++i) {
      const Dart& dart = darts[i];
      if (dart.chance <= 0 || apart.any_near(dart.at, settings_.spacing)) continue;
      apart.insert(dart.at);
      full[i] = 1;
      const std::uint64_t lot = number(i, 2);
      if (unit_real(lot) < dart.chance) kept.emplace_back(mix64(lot), dart.at);
    }
  }
  std::sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (std::ssize(kept) > settings_.count) kept.resize(settings_.count);
  std::vector<Vec3d> out;
  for (const auto& [order, p] : kept) out.push_back({p.x, p.y, ground_.height(p.x, p.y)});
  return out;
}

}  // namespace tafoni::landforms::impl
