#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/landforms/erosion.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/surface.h"
#include "tafoni/math/noise.h"
#include "tafoni/raster/distance.h"
#include "tafoni/raster/resample.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms {
namespace {

struct Params {
  double sea_level = 0;
  double range = 8;
  std::int64_t steps = 3;
  double depth = 2.4;
  double radius = 4.5;
  double beta = 0.12;
  double threshold = 0.06;
  double reach = 30;
  double openness = 20;
  double steepness = 45;
  double joints = 0.6;
  double joint_spacing = 35;
  double roughness = 0.35;
};

ParamTable<Params> table() {
  ParamTable<Params> t;
  t.real("sea_level", &Params::sea_level, "m", -500, 9000, "elevation of the mean sea level")
      .real("range", &Params::range, "m", 0.1, 500, "how far above and below the sea level the waves act")
      .integer("steps", &Params::steps, "", 1, 20, "erosion steps; each acts on the rock the last one left")
      .real("depth", &Params::depth, "m", 0.01, 100,
            "what one step takes off the softest rock under full stress")
      .real("radius", &Params::radius, "m", 0.1, 200, "radius of the eroding spheres of the first step")
      .real("beta", &Params::beta, "", 0, 1, "share of the effect that the hardest rock still suffers")
      .real("threshold", &Params::threshold, "", 0, 1, "effects below this leave no primitive")
      .real("reach", &Params::reach, "m", 0, 10000, "how far from open water a face still feels the waves")
      .real("openness", &Params::openness, "m", 0.5, 1000,
            "radius at which a place counts as wholly accessible")
      .real("steepness", &Params::steepness, "deg", 0, 90, "slope at which a face is cut in full; flats stay")
      .real("joints", &Params::joints, "", 0, 1,
            "how much joints weaken the rock: they become sea caves and arches")
      .real("joint_spacing", &Params::joint_spacing, "m", 1, 5000, "mean distance between joints")
      .real("roughness", &Params::roughness, "", 0, 0.6,
            "noise of the spheres' metric, as a share of the radius");
  return t;
}

double smoothstep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Metres to open water, from every pixel: cells below the sea level and cells without data, unless they are
/// small ponds that touch neither the border nor missing data.
raster::Raster water_distance(const Site& site, double level) {
  const raster::Raster& heights = *site.heights;
  raster::Grid<std::uint8_t> water(heights.width(), heights.height());
  for (int row = 0; row < heights.height(); ++row)
    for (int col = 0; col < heights.width(); ++col)
      water.at(col, row) = (site.valid && !site.valid->at(col, row)) || heights.values.at(col, row) < level;

  constexpr double pond = 2000;  // m^2
  raster::Grid<std::uint8_t> seen(heights.width(), heights.height());
  const double pixel = heights.placement.dx * heights.placement.dy;
  std::vector<Vec2<int>> lake;
  for (int row = 0; row < heights.height(); ++row)
    for (int col = 0; col < heights.width(); ++col) {
      if (!water.at(col, row) || seen.at(col, row)) continue;
      lake.assign(1, {col, row});
      seen.at(col, row) = 1;
      bool open = false;
      for (std::size_t i = 0; i < lake.size(); ++i) {
        const auto [x, y] = lake[i];
        open = open || x == 0 || y == 0 || x + 1 == heights.width() || y + 1 == heights.height() ||
               (site.valid && !site.valid->at(x, y));
        for (const auto& [dx, dy] : {Vec2<int>{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
          if (water.inside(x + dx, y + dy) && water.at(x + dx, y + dy) && !seen.at(x + dx, y + dy)) {
            seen.at(x + dx, y + dy) = 1;
            lake.push_back({x + dx, y + dy});
          }
      }
      if (open || static_cast<double>(lake.size()) * pixel >= pond) continue;
      for (const auto& [x, y] : lake) water.at(x, y) = 0;
    }
  raster::Raster out{{}, heights.placement, {}};
  out.values = raster::signed_distance(water, heights.placement.dx, heights.placement.dy);
  for (float& d : out.values.values()) d = std::isfinite(d) ? std::max(-d, 0.f) : 1e9f;
  return out;
}

class Waves {
 public:
  Waves(const Site& site, const Params& p, Progress& progress)
      : site_(site), p_(p), level_(p.sea_level - site.origin.z), water_(water_distance(site, level_)) {
    open_ = {terrain::accessibility(*site.heights, {p.openness}, progress), site.heights->placement, {}};
  }

  double level() const { return level_; }

  bool may_reach(Vec3d p) const {
    return std::fabs(p.z - level_) <= p_.range && (!site_.region || site_.region->contains(p)) &&
           raster::sample_bilinear(water_, p.x, p.y) <= p_.reach;
  }
  /// sigma = w alpha (document 003, section 6.1), times what keeps the waves to steep faces near open water.
  double stress(const SurfacePoint& s) const {
    const Vec3d& p = s.position;
    const double dz = (p.z - level_) / p_.range;
    if (std::fabs(dz) >= 1) return 0;
    const double w = (1 - dz * dz) * (1 - dz * dz);
    const double flat = std::cos(p_.steepness * std::numbers::pi / 180);
    const double steep = 1 - smoothstep(flat, std::min(flat + 0.25, 1.0), s.normal.z);
    const double near =
        1 - smoothstep(0.6 * p_.reach, p_.reach + 1e-6, raster::sample_bilinear(water_, p.x, p.y));
    const double alpha = 0.35 + 0.65 * raster::sample_bilinear(open_, p.x, p.y);
    return w * alpha * steep * near * (site_.region ? site_.region->weight(p) : 1.0);
  }
  /// 1 in the middle of a joint, 0 between joints. Joints are steep sheets: two families of noise's zero
  /// sets.
  double joint(Vec3d p) const {
    const Vec3d world = p + site_.origin;
    double most = 0;
    for (std::uint64_t family = 0; family < 2; ++family) {
      const double l = 1.6 * p_.joint_spacing;
      const double t =
          fbm({world.x / l, world.y / l, world.z / (6 * l)}, 2, hash_combine(site_.seed, 100 + family));
      most = std::max(most, 1 - smoothstep(0.012, 0.05, std::fabs(t - 0.5)));
    }
    return most;
  }

 private:
  const Site& site_;
  const Params& p_;
  double level_;
  raster::Raster water_, open_;
};

/// Energy of a sheet of points, `spacing` apart and of falloff radius `reach`, that moves a plane surface by
/// `depth`: depth = E n (pi reach^2 / 4) (1 - (depth / reach)^2)^4 with n = 0.7 / spacing^2 points a square
/// metre.
double sheet_energy(double depth, double reach, double spacing) {
  const double q = 1 - depth * depth / (reach * reach);
  return depth * spacing * spacing / (0.7 * std::numbers::pi / 4 * reach * reach * q * q * q * q);
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  const std::vector<ParamInfo> infos = table();
  assign(infos, &p, values, "sea-cliff");
  const Waves waves(site, p, progress);
  Box3d box;
  const auto& place = site.heights->placement;
  box.expand(Vec3d{place.west, place.north - site.heights->height() * place.dy, waves.level() - p.range});
  box.expand(Vec3d{place.west + site.heights->width() * place.dx, place.north, waves.level() + p.range});

  Result result;
  std::int64_t points = 0, weak = 0;
  double energy_sum = 0;
  for (std::int64_t step = 0; step < p.steps; ++step) {
    progress.begin("sea-cliff: step " + std::to_string(step + 1) + " of " + std::to_string(p.steps));
    std::vector<field::NodePtr> ground{site.terrain};
    ground.insert(ground.end(), result.nodes.begin(), result.nodes.end());
    const field::CompiledField field = field::compile(field::combine("blend", ground));
    const double radius = p.radius * std::pow(0.85, static_cast<double>(step));
    const double spacing = 0.5 * radius;
    const auto samples = sample_surface(
        field, box, spacing, hash_combine(site.seed, static_cast<std::uint64_t>(step)),
        [&](Vec3d q) { return waves.may_reach(q); }, progress);

    field::CloudSettings settings;
    settings.noise = {p.roughness * radius, 0.8 * radius, 3, hash_combine(site.seed, 7)};
    field::CloudBuilder cloud(settings);
    Random random(site.seed, 1000 + static_cast<std::uint64_t>(step));
    for (const SurfacePoint& s : samples) {
      const double jitter = random.uniform(0.8, 1.2);
      const double joint = p.joints * waves.joint(s.position);
      const double resistance = site.geology->resistance(s.position) * (1 - joint);
      const double effect = erosion_effect(resistance, waves.stress(s), p.beta);
      if (effect < p.threshold) continue;
      const double reach = radius * jitter * (1 + 0.6 * joint);
      const double depth = std::min(p.depth * effect * (1 + 1.2 * joint), 0.62 * reach);
      // The sphere sits a little inside the rock, level with the point: waves cut sideways.
      const Vec3d inward = normalized(Vec3d{-s.normal.x, -s.normal.y, 0});
      const double energy = sheet_energy(depth, reach, spacing);
      add_point(cloud, s.position + inward * (0.35 * depth), reach, -energy);
      ++points;
      weak += joint > 0.3;
      energy_sum += energy;
    }
    if (cloud.size() > 0) result.nodes.push_back(cloud.finish());
    progress.end();
  }
  if (points == 0)
    progress.warn(
        "sea-cliff found no steep face within its range of the sea level near open water; nothing was "
        "eroded");
  result.report = {{"primitives", points},
                   {"in_joints", weak},
                   {"mean_energy", points ? energy_sum / static_cast<double>(points) : 0.0}};
  return result;
}

}  // namespace

const LandformType& landform_sea_cliff() {
  static const LandformType type{
      "sea-cliff", "Undercuts cliffs at the sea: wave-cut notches, sea caves, arches where rock is weak",
      "document 003, section 6.1", table(), &generate};
  return type;
}

}  // namespace tafoni::landforms
