#include "tafoni/landforms/hoodoos/stands.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/raster/distance.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms::impl {
namespace {

/// Darts thrown at each cell of the Poisson-disk grid; fewer on large terrains.
constexpr std::int64_t fewest_rounds = 4, most_rounds = 24, most_darts = 4'000'000;

double fraction(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace

Stands::Stands(const Ground& ground, const StandSettings& settings, Progress& progress)
    : ground_(ground), settings_(settings) {
  const raster::Raster& heights = *ground.site().heights;
  raster::Raster filled = heights;
  filled.values = terrain::fill_depressions(heights, {}, progress);
  catchment_ = terrain::drainage_area(filled, 1.1, progress);
  if (settings.river > 0) {
    raster::Grid<std::uint8_t> rivers(heights.width(), heights.height());
    for (std::size_t i = 0; i < rivers.size(); ++i)
      rivers.data()[i] = static_cast<double>(catchment_.data()[i]) >= settings.river_area;
    river_ = raster::signed_distance(rivers, heights.placement.dx, heights.placement.dy, progress);
  }
  const auto across = static_cast<float>(1 / ground.pixel());
  for (float& area : catchment_.values()) area *= across;
}

double Stands::slope(double x, double y) const {
  const double d = 0.5 * settings_.across;
  const double sx = ground_.height(x + d, y) - ground_.height(x - d, y);
  const double sy = ground_.height(x, y + d) - ground_.height(x, y - d);
  return std::hypot(sx, sy) / (2 * d);
}

double Stands::chance(double x, double y) const {
  const Vec3d p{x, y, ground_.height(x, y)};
  if (!ground_.usable(p, settings_.margin)) return 0;
  const double s = std::atan(slope(x, y)) / degree;
  const StandSettings& set = settings_;
  double chance = smoothstep(0.7 * set.slope_from, set.slope_from, s) *
                  (1 - smoothstep(set.slope_to, set.slope_to + 10, s));
  if (chance == 0) return 0;
  // Not on the brink of a cliff, rather on a crest than in a hollow.
  double lowest = p.z, mean = 0;
  for (int k = 0; k < 8; ++k) {
    const double a = 45 * degree * k;
    const double z = ground_.height(x + set.across * std::cos(a), y + set.across * std::sin(a));
    lowest = std::min(lowest, z);
    mean += z / 8;
  }
  chance *= 1 - smoothstep(1.2, 1.8, (p.z - lowest) / set.across);
  chance *= 1 - set.ridges * (1 - smoothstep(-0.05, 0.12, (p.z - mean) / set.across));
  const double group = 1 / (8 * set.spacing);
  const float gathered = fbm({x * group, y * group, 0.37}, 2, hash_combine(set.seed, 0xc1));
  chance *= 1 - set.clusters * (1 - smoothstep(0.42, 0.58, static_cast<double>(gathered)));
  if (chance == 0) return 0;
  const Vec2d at = ground_.site().heights->placement.pixel(x, y);
  const auto nearest = [&](const raster::Grid<float>& grid, double dx, double dy) {
    return static_cast<double>(
        grid.at(std::clamp(static_cast<int>(std::lround(at.x + dx)), 0, grid.width() - 1),
                std::clamp(static_cast<int>(std::lround(at.y + dy)), 0, grid.height() - 1)));
  };
  // A gully beside the place counts too.
  double most = 0;
  const double aside = 0.2 * set.across / ground_.pixel();
  for (const double dx : {-aside, 0.0, aside})
    for (const double dy : {-aside, 0.0, aside}) most = std::max(most, nearest(catchment_, dx, dy));
  chance *= 1 - smoothstep(0.5 * set.catchment, set.catchment, most);
  if (!river_.empty()) {
    const double bank = -nearest(river_, 0, 0);
    chance *=
        smoothstep(0.3 * set.margin, set.margin, bank) * (1 - smoothstep(0.6 * set.river, set.river, bank));
  }
  return set.density * chance * ground_.weight(p);
}

std::vector<Vec3d> Stands::places(const std::vector<Vec3d>& taken) const {
  const Box3d& box = ground_.box();
  if (box.empty()) return {};
  const double cell = settings_.spacing * 0.7071;
  const auto columns = static_cast<std::int64_t>(std::ceil((box.hi.x - box.lo.x) / cell));
  const auto rows = static_cast<std::int64_t>(std::ceil((box.hi.y - box.lo.y) / cell));
  const std::int64_t rounds = std::clamp(most_darts / (columns * rows), fewest_rounds, most_rounds);
  const Random random(settings_.seed, 0x5ead);
  struct Dart {
    Vec3d at;
    double chance;
  };
  // A cell is smaller than the spacing, so it holds one at most.
  std::vector<std::uint8_t> full(static_cast<std::size_t>(columns * rows));
  std::vector<Dart> darts(static_cast<std::size_t>(columns * rows));
  SpatialHash apart(2 * settings_.spacing);
  for (const Vec3d p : taken) apart.insert({p.x, p.y, 0});
  std::vector<std::pair<std::uint64_t, Vec3d>> kept;
  for (std::int64_t round = 0; round < rounds; ++round) {
    const auto number = [&](std::int64_t i, int which) {
      return random.at(static_cast<std::uint64_t>((i * rounds + round) * 3 + which));
    };
    parallel_blocks(rows, 4, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t i = from * columns; i < to * columns; ++i) {
        darts[static_cast<std::size_t>(i)].chance = 0;
        if (full[static_cast<std::size_t>(i)] != 0) continue;
        const Vec3d p{box.lo.x + cell * (static_cast<double>(i % columns) + fraction(number(i, 0))),
                      box.lo.y + cell * (static_cast<double>(i / columns) + fraction(number(i, 1))), 0};
        darts[static_cast<std::size_t>(i)] = {p, chance(p.x, p.y)};
      }
    });
    for (std::int64_t i = 0; i < columns * rows; ++i) {
      const Dart& dart = darts[static_cast<std::size_t>(i)];
      if (dart.chance <= 0 || apart.any_near(dart.at, settings_.spacing)) continue;
      apart.insert(dart.at);
      full[static_cast<std::size_t>(i)] = 1;
      const std::uint64_t lot = number(i, 2);
      if (fraction(lot) < dart.chance) kept.emplace_back(mix64(lot), dart.at);
    }
  }
  std::sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (kept.size() > settings_.most) kept.resize(settings_.most);
  std::vector<Vec3d> out;
  for (const auto& [order, p] : kept) out.push_back({p.x, p.y, ground_.height(p.x, p.y)});
  return out;
}

}  // namespace tafoni::landforms::impl
