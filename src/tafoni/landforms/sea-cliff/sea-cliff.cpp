#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/landforms/rock/joints.h"
#include "tafoni/landforms/sea-cliff/sea_caves.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/math/noise.h"
#include "tafoni/raster/distance.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms {
namespace {

using impl::Attack;
using impl::CaveSettings;
using impl::CaveTube;
using impl::Ground;
using impl::Joints;
using impl::SeaCaves;

struct Params {
  double sea_level = 0;
  double range = 8;
  std::int64_t steps = 3;
  double retreat = 6;
  double reach = 40;
  double weathering = 1.6;
  double radius = 5;
  double spacing = 2.2;
  double beta = 0.15;
  double threshold = 0.06;
  double accessibility = 0.5;
  double accessibility_radius = 20;
  double slope = 28;
  double joints = 0.7;
  double joint_spacing = 22;
  double roughness = 0.35;
  double cave_spacing = 45;
  double cave_length = 25;
  double cave_radius = 2.5;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("sea_level", &Params::sea_level, "m", -12000, 10000, "mean elevation of the sea")
        .real("range", &Params::range, "m", 0.5, 200, "how far above and below the sea level waves act")
        .integer("steps", &Params::steps, "", 1, 12, "times that the sea acts on the shape it has left")
        .real("retreat", &Params::retreat, "m", 0.1, 100,
              "about how deep one step cuts into the softest rock under full stress")
        .real("reach", &Params::reach, "m", 1, 100000,
              "how far from the shoreline, on land and off it, faces feel the sea")
        .real("weathering", &Params::weathering, "m", 0, 50,
              "how deep the softest beds weather back on the rest of the faces, 0 for not at all")
        .real("radius", &Params::radius, "m", 0.2, 100, "reach of one carving primitive of the first step")
        .real("spacing", &Params::spacing, "m", 0.1, 50,
              "least distance between primitives of the first step")
        .real("beta", &Params::beta, "", 0, 1, "effect of full stress on the most resistant rock")
        .real("threshold", &Params::threshold, "", 0, 1, "erosion effect below which nothing is carved")
        .real("accessibility", &Params::accessibility, "", 0, 1,
              "how much sheltered places are spared, 0 for not at all")
        .real("accessibility_radius", &Params::accessibility_radius, "m", 1, 200,
              "size of open space before a place that counts as fully exposed")
        .real("slope", &Params::slope, "deg", 0, 85,
              "ground gentler than this is beach or platform and is kept")
        .real("joints", &Params::joints, "", 0, 1, "how much vertical joints weaken the rock")
        .real("joint_spacing", &Params::joint_spacing, "m", 1, 1000, "mean distance between joints")
        .real("roughness", &Params::roughness, "", 0, 1, "unevenness of what is carved")
        .real("cave_spacing", &Params::cave_spacing, "m", 0, 10000,
              "least distance between sea caves along the coast, 0 for none")
        .real("cave_length", &Params::cave_length, "m", 1, 500,
              "length of caves, and thickness up to which a headland is pierced to an arch")
        .real("cave_radius", &Params::cave_radius, "m", 0.3, 50, "half the width of a cave's passage");
    return t;
  }();
  return params;
}

/// Steps get finer: later ones etch beds and joints into what the first has cut.
double scale_of_step(std::int64_t step) {
  return std::max(0.4, std::pow(0.78, static_cast<double>(step)));
}

class SeaCliff {
 public:
  SeaCliff(const Site& site, const Params& p, Progress& progress)
      : p_(p),
        ground_(site),
        joints_(p.joint_spacing, std::max(1.2, 0.1 * p.joint_spacing), hash_combine(site.seed, 0x4a)),
        sea_z_(p.sea_level - site.origin.z),
        gentle_(std::cos(p.slope * 3.14159265358979323846 / 180)),
        tree_(site.terrain),
        progress_(progress) {}

  Result run() {
    Result result;
    if (band().empty()) return report(std::move(result));
    water_ = water_distance();
    open_ = exposure();
    for (std::int64_t step = 0; step < p_.steps; ++step) add(notch(step), result);
    if (p_.cave_spacing > 0) add(caves(), result);
    if (p_.weathering > 0) add(weather(), result);
    return report(std::move(result));
  }

 private:
  Box3d band() const {
    Box3d box = ground_.box();
    box.lo.z = std::max(box.lo.z, sea_z_ - p_.range);
    box.hi.z = std::min(box.hi.z, sea_z_ + p_.range);
    return box;
  }

  void add(field::NodePtr node, Result& result) {
    if (!node) return;
    result.nodes.push_back(node);
    tree_ = field::blend({tree_, std::move(node)});
  }

  /// Miller's accessibility, the best within a few metres: the foot of a straight cliff is no sheltered nook.
  raster::Raster exposure() {
    const raster::Raster& heights = *ground_.site().heights;
    raster::Raster open;
    open.placement = heights.placement;
    if (p_.accessibility <= 0) return open;
    const int reach =
        std::clamp(static_cast<int>(std::lround(0.25 * p_.accessibility_radius / ground_.pixel())), 0, 6);
    const auto wanted = shore(reach + 2);
    const auto grid = terrain::accessibility(heights, {p_.accessibility_radius, &wanted}, progress_);
    open.values = raster::Grid<float>(grid.width(), grid.height());
    parallel_blocks(grid.height(), 16, [&](std::int64_t begin, std::int64_t end) {
      for (int row = static_cast<int>(begin); row < end; ++row)
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
  raster::Grid<std::uint8_t> shore(int more) const {
    const raster::Grid<float>& heights = ground_.site().heights->values;
    raster::Grid<std::uint8_t> out(heights.width(), heights.height(), 1);
    if (water_.values.empty()) return out;
    const auto limit = static_cast<float>(p_.reach + more * ground_.pixel());
    for (std::size_t i = 0; i < out.size(); ++i)
      out.values()[i] = std::abs(water_.values.values()[i]) <= limit;
    return out;
  }

  /// Metres to open water: ground below the sea level, or none at all where there is no data. Empty when
  /// there is no water, and then the sea acts on all there is in its range.
  raster::Raster water_distance() const {
    const raster::Raster& heights = *ground_.site().heights;
    raster::Grid<std::uint8_t> land(heights.width(), heights.height(), 1);
    bool any = false;
    for (int row = 0; row < heights.height(); ++row)
      for (int col = 0; col < heights.width(); ++col)
        if (heights.values.at(col, row) < sea_z_ ||
            (ground_.site().valid && !ground_.site().valid->at(col, row))) {
          land.at(col, row) = 0;
          any = true;
        }
    raster::Raster distance;
    distance.placement = heights.placement;
    if (any)
      distance.values =
          raster::signed_distance(land, distance.placement.dx, distance.placement.dy, progress_);
    return distance;
  }

  static float nearest(const raster::Raster& raster, Vec3d p) {
    const Vec2d at = raster.placement.pixel(p.x, p.y);
    return raster.values.at(std::clamp(static_cast<int>(std::lround(at.x)), 0, raster.width() - 1),
                            std::clamp(static_cast<int>(std::lround(at.y)), 0, raster.height() - 1));
  }

  double accessibility(Vec3d p) const {
    return open_.values.empty() ? 1 : 1 - p_.accessibility * (1 - nearest(open_, p));
  }

  double nearness(Vec3d p) const {
    return water_.values.empty() ? 1 : 1 - smoothstep(0.6 * p_.reach, p_.reach, std::abs(nearest(water_, p)));
  }

  /// 1 on faces, 0 on ground gentler than the limit; ceilings give way less than walls, so that notches
  /// grow inward rather than upward.
  double steepness(Vec3f normal) const {
    const double nz = static_cast<double>(normal.z);
    return smoothstep(0, 0.22, gentle_ - nz) * (nz < 0 ? 1 + 0.65 * nz : 1);
  }

  /// How much of the sea reaches a place, whatever its elevation; none on platforms.
  double exposed(const SurfacePoint& at) const {
    const double steep = steepness(at.normal);
    return steep > 0 ? steep * nearness(at.position) * ground_.weight(at.position) : 0;
  }

  /// sigma = w alpha [Paris19 §6.1], spared where the ground is a platform.
  double stress(const SurfacePoint& at) const {
    const double u = (at.position.z - sea_z_) / p_.range;
    if (u * u >= 1) return 0;
    const double open = exposed(at);
    return open > 0 ? (1 - u * u) * accessibility(at.position) * open : 0;
  }

  double resistance(Vec3d p) const { return jointed(ground_.resistance(p), p); }
  double jointed(double rho, Vec3d p) const {
    return rho * (1 - p_.joints * joints_.weakness(p + ground_.site().origin));
  }

  /// Samples of the exposed faces in `box`, each with e(rho, stress).
  template <class Stress>
  std::vector<Attack> attacked(const field::CompiledField& field, const Box3d& box, double spacing,
                               double beta, std::uint64_t stream, Stress stress_at) {
    SurfaceSampling sampling;
    sampling.spacing = spacing;
    sampling.box = box;
    sampling.seed = hash_combine(ground_.site().seed, stream);
    sampling.maybe = [this](Vec3d p, double around) {
      return water_.values.empty() || std::abs(nearest(water_, p)) < p_.reach + around + 2 * ground_.pixel();
    };
    // e is never above the stress, so what the threshold drops need not be sampled.
    sampling.accept = [this, &stress_at](const SurfacePoint& at) {
      const double stress = stress_at(at);
      return stress > 0 && stress >= p_.threshold && ground_.usable(at.position);
    };
    const auto points = sample_surface(field, sampling, progress_);
    std::vector<Vec3d> places(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) places[i] = points[i].position;
    std::vector<float> rho(places.size());
    ground_.resistances(places, rho);
    std::vector<Attack> attacks(points.size());
    parallel_blocks(static_cast<std::int64_t>(points.size()), 256, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        attacks[i] = {points[i], erosion_effect(jointed(static_cast<double>(rho[i]), places[i]),
                                                stress_at(points[i]), beta)};
    });
    std::erase_if(attacks, [this](const Attack& a) { return a.effect < p_.threshold; });
    return attacks;
  }

  std::vector<Attack> attacked_by_sea(const field::CompiledField& field, double spacing,
                                      std::uint64_t stream) {
    return attacked(field, band(), spacing, p_.beta, stream,
                    [this](const SurfacePoint& at) { return stress(at); });
  }

  /// Energy of a primitive so that all together take `depth` off a face of effect 1. Dart throwing leaves
  /// about 0.7 samples a spacing squared, and a primitive on a plane integrates to E pi R^2 / 4 over it.
  static double share(double depth, double radius, double spacing) {
    return depth / std::max(1.0, 0.7 * 0.785 * (radius / spacing) * (radius / spacing));
  }

  /// Uneven rock: noise once a primitive costs nothing beside noise in every primitive's metric.
  double uneven(Vec3d p, double size, std::uint64_t stream) const {
    const double t =
        fbm((p + ground_.site().origin) * (1 / size), 3, hash_combine(ground_.site().seed, stream));
    return std::max(0.0, 1 + 3 * p_.roughness * (2 * t - 1));
  }

  /// Frost and rain on the faces above the waves: soft beds recede, hard ones stand out.
  field::NodePtr weather() {
    const field::CompiledField field = field::compile(tree_);
    const double radius = 0.4 * p_.radius, spacing = 0.5 * radius;
    Box3d box = ground_.box();
    box.lo.z = std::max(box.lo.z, sea_z_ - 0.5 * p_.range);
    const auto attacks =
        attacked(field, box, spacing, 0, 0x3e, [this](const SurfacePoint& at) { return exposed(at); });
    field::CloudBuilder cloud{field::CloudSettings{}};
    const double energy = share(p_.weathering, radius, spacing);
    Random random(ground_.site().seed, 0x3f);
    for (const Attack& a : attacks) {
      const double r = radius * random.uniform(0.6, 1.4);
      add_point(cloud, a.at.position, r, -energy * a.effect * uneven(a.at.position, 2 * radius, 0x3d));
    }
    primitives_ += static_cast<std::int64_t>(cloud.size());
    return cloud.size() ? cloud.finish() : nullptr;
  }

  /// f at `probes` places for each attack: place(attack, k). body(i, values) gets those of attack i. In
  /// blocks, since there may be millions of places.
  template <int probes, class Place, class Body>
  static void probe(const field::CompiledField& field, const std::vector<Attack>& attacks, const Place& place,
                    const Body& body) {
    constexpr std::int64_t block = 128;
    parallel_blocks(static_cast<std::int64_t>(attacks.size()), block,
                    [&](std::int64_t begin, std::int64_t end) {
                      std::vector<Vec3d> points;
                      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                        for (int k = 0; k < probes; ++k) points.push_back(place(attacks[i], k));
                      std::vector<float> values(points.size());
                      field.values(points, values);
                      for (std::int64_t i = begin; i < end; ++i)
                        body(static_cast<std::size_t>(i), values.data() + (i - begin) * probes);
                    });
  }

  /// Lifts a primitive that would dig into the platform before the cliff.
  std::vector<double> lifts(const field::CompiledField& field, const std::vector<Attack>& attacks,
                            double radius) const {
    constexpr int probes = 6;
    const double want = 0.7 * radius;
    std::vector<double> lift(attacks.size(), 0.0);
    probe<probes>(
        field, attacks,
        [&](const Attack& a, int k) {
          return a.at.position + to_double(a.at.normal) * (0.35 * radius) -
                 Vec3d{0, 0, want * (k + 1) / probes};
        },
        [&](std::size_t i, const float* values) {
          const auto first = std::find_if(values, values + probes, [](float f) { return f > 0; });
          if (first != values + probes) lift[i] = want * (1 - static_cast<double>(first - values) / probes);
        });
    return lift;
  }

  /// Spares necks: cut from both sides a stack would come to float. The factor is 0 where the rock inward of
  /// a place is hardly thicker than a primitive's radius, 1 from three times that on.
  std::vector<double> strength(const field::CompiledField& field, const std::vector<Attack>& attacks,
                               double radius) const {
    constexpr int probes = 12;
    std::vector<double> factor(attacks.size(), 1.0);
    probe<probes>(
        field, attacks,
        [&](const Attack& a, int k) {
          return a.at.position - horizontal(a.at.normal) * (3 * radius * (k + 1) / probes);
        },
        [&](std::size_t i, const float* values) {
          // The first probe may still lie in the air before a rough face.
          const auto air = std::find_if(values + 1, values + probes, [](float f) { return f <= 0; });
          if (air != values + probes)
            factor[i] = smoothstep(0.9, 3, 3 * static_cast<double>(air - values) / probes);
        });
    return factor;
  }

  static Vec3d horizontal(Vec3f normal) {
    return normalized(Vec3d{to_double(normal).x, to_double(normal).y, 0});
  }

  field::NodePtr notch(std::int64_t step) {
    const field::CompiledField field = field::compile(tree_);
    const double scale = scale_of_step(step);
    const double radius = p_.radius * scale, spacing = std::min(p_.spacing * scale, 0.75 * radius);
    const auto attacks = attacked_by_sea(field, spacing, static_cast<std::uint64_t>(step));
    const auto lift = lifts(field, attacks, radius);
    const auto sound = strength(field, attacks, p_.radius);
    const double energy = share(p_.retreat, radius, spacing);
    field::CloudBuilder cloud{field::CloudSettings{}};
    Random random(ground_.site().seed, 0x100 + static_cast<std::uint64_t>(step));
    for (std::size_t i = 0; i < attacks.size(); ++i) {
      const Attack& a = attacks[i];
      const double r = radius * random.uniform(0.7, 1.3);
      // Waves drive inward: the sea undercuts even a face that leans back.
      const double effect = a.effect * sound[i];
      const Vec3d center =
          a.at.position + Vec3d{0, 0, lift[i]} - horizontal(a.at.normal) * (0.5 * r * std::sqrt(effect));
      if (effect < p_.threshold || !ground_.usable(center)) continue;
      add_point(cloud, center, r, -energy * effect * uneven(a.at.position, radius, 0x6e));
      strongest_ = std::max(strongest_, a.effect);
    }
    primitives_ += static_cast<std::int64_t>(cloud.size());
    return cloud.size() ? cloud.finish() : nullptr;
  }

  field::NodePtr caves() {
    const field::CompiledField field = field::compile(tree_);
    auto attacks = attacked_by_sea(field, p_.spacing, 0x77);
    std::erase_if(attacks, [this](const Attack& a) {
      return std::abs(a.at.position.z - sea_z_) > 0.6 * p_.range || std::abs(a.at.normal.z) > 0.75f;
    });
    CaveSettings settings;
    settings.sea_z = sea_z_;
    settings.spacing = p_.cave_spacing;
    settings.length = p_.cave_length;
    settings.radius = p_.cave_radius;
    settings.joints = p_.joints;
    settings.seed = hash_combine(ground_.site().seed, 0xca);
    made_ = sea_caves(field, ground_, joints_, std::move(attacks), settings, progress_);
    if (made_.tubes.empty()) return nullptr;
    field::CloudBuilder cloud{field::CloudSettings{}};
    Random random(settings.seed, 1);
    for (const CaveTube& tube : made_.tubes) bore(cloud, tube, random);
    return cloud.size() ? cloud.finish() : nullptr;
  }

  /// A tube as a line of points, unevenly wide, so that its walls are not turned on a lathe.
  void bore(field::CloudBuilder& cloud, const CaveTube& tube, Random& random) {
    const double reach = 1.6 * tube.radius, step = 0.5 * tube.radius;
    const double energy = tube_energy(ground_.site().amplitude, tube.radius, reach, step);
    const double span = length(tube.to - tube.from);
    const int n = std::max(1, static_cast<int>(std::lround(span / step)));
    for (int i = 0; i < n; ++i) {
      const double wobble = p_.roughness * tube.radius;
      const Vec3d jitter{random.uniform(-wobble, wobble), random.uniform(-wobble, wobble),
                         random.uniform(-wobble, wobble)};
      const Vec3d at = tube.from + (tube.to - tube.from) * ((i + 0.5) / n) + jitter;
      if (!ground_.usable(at)) continue;
      add_point(cloud, at, reach * random.uniform(0.85, 1.15), -energy * span / (n * step));
      ++primitives_;
      pocket(cloud, at, tube.radius, random);
    }
  }

  /// The walls of caves recede where the bed is soft.
  void pocket(field::CloudBuilder& cloud, Vec3d at, double radius, Random& random) {
    const Vec3d d = normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.3, 1)});
    const Vec3d wall = at + d * (radius * random.uniform(0.7, 1.0));
    const double soft = 1 - resistance(wall);
    if (soft < 0.1 || !ground_.usable(wall)) return;
    add_point(cloud, wall, radius * random.uniform(0.35, 0.75),
              -4 * p_.roughness * ground_.site().amplitude * soft);
    ++primitives_;
  }

  Result report(Result result) const {
    result.report.emplace_back("primitives", primitives_);
    result.report.emplace_back("strongest_effect", strongest_);
    result.report.emplace_back("caves", static_cast<std::int64_t>(made_.mouths.size()));
    std::vector<double> mouths;
    for (Vec3d p : made_.mouths)
      for (double v :
           {p.x + ground_.site().origin.x, p.y + ground_.site().origin.y, p.z + ground_.site().origin.z})
        mouths.push_back(v);
    result.report.emplace_back("cave_positions", std::move(mouths));
    result.report.emplace_back("arches", static_cast<std::int64_t>(made_.arches));
    result.report.emplace_back("cave_passage_m", made_.length);
    return result;
  }

  const Params& p_;
  Ground ground_;
  Joints joints_;
  double sea_z_;
  double gentle_;  ///< the normal's z above which ground is beach or platform
  field::NodePtr tree_;
  Progress& progress_;
  raster::Raster open_, water_;
  SeaCaves made_;
  std::int64_t primitives_ = 0;
  double strongest_ = 0;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "sea-cliff");
  return SeaCliff(site, p, progress).run();
}

}  // namespace

const LandformType& landform_sea_cliff() {
  static const LandformType type{
      .about = {.name = "sea-cliff",
                .doc = "Wave-cut notches, overhanging cliffs, sea caves and arches about the sea level",
                .source = "[Paris19 §6.1]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
