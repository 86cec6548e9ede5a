// Sea cliffs: in a few steps, ever finer, waves notch the faces about the sea level where rock and shelter
// allow; then caves follow the joints, and frost and rain etch the beds above [Paris19 §6.1]. All of it is
// negative points.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/landforms/rock/joints.h"
#include "tafoni/landforms/sea-cliff/sea_caves.h"
#include "tafoni/landforms/sea-cliff/shore.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/math/counts.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::landform_sea_cliff {
namespace {

using impl::Attack;
using impl::CaveSettings;
using impl::CaveTube;
using impl::Ground;
using impl::Joints;
using impl::SeaCaves;

enum class Stream : std::uint64_t {
  steps = 0,
  weathering_unevenness = 0x3d,
  weathering = 0x3e,
  weathering_sizes = 0x3f,
  joints = 0x4a,
  unevenness = 0x6e,
  cave_mouths = 0x77,
  caves = 0xca,
  step_sizes = 0x100
};
/// Streams of the caves' own seed; the first walk of sea_caves has the same number.
enum class CaveStream : std::uint64_t { bores = 1 };

/// Chosen by eye.
namespace look {
// Joints' half-width: in metres at least, and as a share of their spacing.
constexpr double least_joint = 1.2, joint_width = 0.1;
// Each step's primitives are so much smaller than the last one's, down to this share of the first step's.
constexpr double finer = 0.78, finest = 0.4;
// The normal's z beyond the limit of slope over which ground turns from a platform to a face.
constexpr double face_rise = 0.22;
// Share of the stress that a level ceiling is spared: more makes notches that grow inward, not upward.
constexpr double ceiling = 0.65;
// Strength of the noise at roughness 1: so much that some primitives vanish and others are more than twice
// as strong.
constexpr double unevenness = 3;

// Primitives of a step: their spacing is at most this share of the radius, or notches fall apart into holes;
// their sizes vary; full effect moves them so far inward, in radii.
constexpr double notch_spacing = 0.75, notch_small = 0.7, notch_large = 1.3, notch_inward = 0.5;
// A primitive is lifted off the platform by so many radii at most; the ground is looked for this many radii
// before the face.
constexpr double lift = 0.7, lift_before = 0.35;
// Rock inward of a place is looked at as far as `neck` radii: thinner than `neck_thin` is not cut at all.
constexpr double neck = 3, neck_thin = 0.9;

// Weathering is finer work than the waves': radius in those of the first step, spacing and the size of
// uneven patches in its own, sizes; and it reaches this share of the range below the sea level.
constexpr double weather_radius = 0.4, weather_spacing = 0.5, weather_patch = 2;
constexpr double weather_small = 0.6, weather_large = 1.4, weather_below = 0.5;

// Caves open within this share of the range of the sea level, in faces that are no steeper ceilings or
// flatter ledges than this (the normal's z).
constexpr double cave_band = 0.6;
constexpr float cave_level = 0.75f;
// A cave's bore: reach and step of its points in radii of the tube, so that their sum is even along it, and
// how their sizes vary.
constexpr double bore_reach = 1.6, bore_step = 0.5, bore_small = 0.85, bore_large = 1.15;
// Pockets in a cave's wall: how far from its axis and how large, in radii, how far down they look, how strong
// they are in the softest rock, in amplitudes; harder rock than `pocket_least` gets none.
constexpr double pocket_near = 0.7, pocket_far = 1.0, pocket_small = 0.35, pocket_large = 0.75;
constexpr double pocket_down = -0.3, pocket_strength = 4, pocket_least = 0.1;
}  // namespace look

struct Params : CaveSettings, impl::ShoreSettings {
  double sea_level = 0;
  double range = 8;
  std::int64_t steps = 3;
  double retreat = 6;
  double weathering = 1.6;
  double radius = 5;
  double spacing = 2.2;
  double beta = 0.15;
  double threshold = 0.06;
  double slope = 28;
  double joint_spacing = 22;
  double roughness = 0.35;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("sea_level", &Params::sea_level, "m", -12000, 10000, "Mean elevation of the sea")
        .real("range", &Params::range, "m", 0.5, 200, "How far above and below the sea level waves act")
        .integer(
            "steps", &Params::steps, "", 1, 12,
            "How many times the sea acts on the shape that it has left: more etches beds and joints finer")
        .real("retreat", &Params::retreat, "m", 0.1, 100,
              "About how deep one step cuts into the softest rock under full stress")
        .real("reach", &Params::reach, "m", 1, 100000,
              "How far from the shoreline, on land and off it, faces feel the sea")
        .real("weathering", &Params::weathering, "m", 0, 50,
              "How deep the softest beds weather back on the rest of the faces; 0 for not at all")
        .real("radius", &Params::radius, "m", 0.2, 100,
              "Reach of one carving primitive of the first step; later steps use finer ones")
        .real("spacing", &Params::spacing, "m", 0.1, 50,
              "Least distance between primitives of the first step")
        .real("beta", &Params::beta, "", 0, 1,
              "Effect of full stress on the most resistant rock; less lets hard beds stand out")
        .real("threshold", &Params::threshold, "", 0, 1, "Erosion effect below which nothing is carved")
        .real("accessibility", &Params::accessibility, "", 0, 1,
              "How much sheltered places are spared; 0 for not at all")
        .real("accessibility_radius", &Params::accessibility_radius, "m", 1, 200,
              "Size of the open space before a place that counts as fully exposed")
        .real("slope", &Params::slope, "deg", 0, 85,
              "Ground gentler than this is beach or platform and is kept")
        .real("joints", &Params::joints, "", 0, 1,
              "How much vertical joints weaken the rock: more makes clefts and aligned caves, 0 none")
        .real("joint_spacing", &Params::joint_spacing, "m", 1, 1000, "Mean distance between joints")
        .real("roughness", &Params::roughness, "", 0, 1, "Unevenness of what is carved; 0 for smooth notches")
        .real("cave_spacing", &Params::cave_spacing, "m", 0, 10000,
              "Least distance between sea caves along the coast; 0 for none")
        .real("cave_length", &Params::cave_length, "m", 1, 500,
              "Length of caves, and the thickness up to which a headland is pierced to an arch")
        .real("cave_radius", &Params::cave_radius, "m", 0.3, 50, "Half the width of a cave's passage");
    return t;
  }();
  return params;
}

/// Each step draws from a stream of its own.
Stream stream_of(Stream first, std::int64_t step) {
  return static_cast<Stream>(static_cast<std::uint64_t>(first) + step);
}

/// Steps get finer: later ones etch beds and joints into what the first has cut.
double scale_of_step(std::int64_t step) {
  return std::max(look::finest, std::pow(look::finer, step));
}

class SeaCliff {
 public:
  SeaCliff(const Site& site, const Params& p, Progress& progress)
      : p_(p),
        ground_(site),
        joints_(p.joint_spacing, std::max(look::least_joint, look::joint_width * p.joint_spacing),
                hash_combine(site.seed, Stream::joints)),
        sea_z_(p.sea_level - site.origin.z),
        gentle_(std::cos(p.slope * std::numbers::pi / 180)),
        tree_(site.terrain),
        progress_(progress) {}

  Result run() {
    Result result;
    if (band().empty()) return report(std::move(result));
    shore_.emplace(ground_, p_, sea_z_, progress_);
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

  /// 1 on faces, 0 on ground gentler than the limit; ceilings give way less than walls, so that notches
  /// grow inward rather than upward.
  double steepness(Vec3f normal) const {
    const double nz = normal.z;
    return smoothstep(0.0, look::face_rise, gentle_ - nz) * (nz < 0 ? 1 + look::ceiling * nz : 1);
  }

  /// How much of the sea reaches a place, whatever its elevation; it is 0 on platforms.
  double exposure(const SurfaceSample& at) const {
    const double steep = steepness(at.normal);
    return steep > 0 ? steep * shore_->nearness(at.position) * ground_.weight(at.position) : 0;
  }

  /// The stress sigma = w alpha [Paris19 §6.1]; a platform is spared.
  double stress(const SurfaceSample& at) const {
    const double u = (at.position.z - sea_z_) / p_.range;
    if (u * u >= 1) return 0;
    const double open = exposure(at);
    return open > 0 ? (1 - u * u) * shore_->accessibility(at.position) * open : 0;
  }

  double resistance(Vec3d p) const { return weaken_by_joints(ground_.resistance(p), p); }
  double weaken_by_joints(double rho, Vec3d p) const {
    return rho * (1 - p_.joints * joints_.weakness(p + ground_.site().origin));
  }

  /// Samples of the exposed faces in `box`, each with e(rho, stress).
  template <class Stress>
  std::vector<Attack> attacks_on(const field::CompiledField& field, const Box3d& box, double spacing,
                                 double beta, Stream stream, Stress stress_at) {
    SurfaceSampling sampling;
    sampling.spacing = spacing;
    sampling.box = box;
    sampling.seed = hash_combine(ground_.site().seed, stream);
    sampling.maybe = [this](Vec3d p, double around) { return shore_->may_reach(p, around); };
    // e is never above the stress, so what the threshold drops need not be sampled.
    sampling.accept = [this, &stress_at](const SurfaceSample& at) {
      const double stress = stress_at(at);
      return stress > 0 && stress >= p_.threshold && ground_.usable(at.position);
    };
    const auto points = sample_surface(field, sampling, progress_);
    std::vector<Vec3d> places(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) places[i] = points[i].position;
    std::vector<float> rho(places.size());
    ground_.resistances(places, rho);
    std::vector<Attack> attacks(points.size());
    parallel_blocks(std::ssize(points), 256, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i)
        attacks[i] = {points[i],
                      erosion_effect(weaken_by_joints(rho[i], places[i]), stress_at(points[i]), beta)};
    });
    std::erase_if(attacks, [this](const Attack& a) { return a.effect < p_.threshold; });
    return attacks;
  }

  std::vector<Attack> sea_attacks(const field::CompiledField& field, double spacing, Stream stream) {
    return attacks_on(field, band(), spacing, p_.beta, stream,
                      [this](const SurfaceSample& at) { return stress(at); });
  }

  /// Energy of a primitive so that all together take `depth` off a face of effect 1.
  static double share(double depth, double radius, double spacing) {
    return depth / overlap_of_darts(radius, spacing);
  }

  /// Uneven rock: noise once a primitive costs nothing beside noise in every primitive's metric.
  double uneven(Vec3d p, double size, Stream stream) const {
    const double t =
        fbm((p + ground_.site().origin) * (1 / size), 3, hash_combine(ground_.site().seed, stream));
    return std::max(0.0, 1 + look::unevenness * p_.roughness * (2 * t - 1));
  }

  /// Frost and rain on the faces above the waves: soft beds recede, hard ones stand out.
  field::NodePtr weather() {
    const field::CompiledField field = field::compile(tree_);
    const double radius = look::weather_radius * p_.radius, spacing = look::weather_spacing * radius;
    Box3d box = ground_.box();
    box.lo.z = std::max(box.lo.z, sea_z_ - look::weather_below * p_.range);
    const auto attacks = attacks_on(field, box, spacing, 0, Stream::weathering,
                                    [this](const SurfaceSample& at) { return exposure(at); });
    field::CloudBuilder cloud{field::CloudSettings{}};
    const double energy = share(p_.weathering, radius, spacing);
    Random random(ground_.site().seed, Stream::weathering_sizes);
    for (const Attack& a : attacks) {
      const double r = radius * random.uniform(look::weather_small, look::weather_large);
      add_point(cloud, a.at.position, r,
                -energy * a.effect *
                    uneven(a.at.position, look::weather_patch * radius, Stream::weathering_unevenness));
    }
    primitives_ += cloud.size();
    return cloud.size() ? cloud.finish() : nullptr;
  }

  /// Evaluates f at `probes` places for each attack, which place(attack, k) says; body(i, values) gets those
  /// of attack i. The work goes in blocks, since there may be millions of places.
  template <int probes, class Place, class Body>
  static void probe(const field::CompiledField& field, const std::vector<Attack>& attacks, const Place& place,
                    const Body& body) {
    constexpr std::int64_t block = 128;
    parallel_blocks(std::ssize(attacks), block, [&](std::int64_t begin, std::int64_t end) {
      std::vector<Vec3d> points;
      for (std::int64_t i = begin; i < end; ++i)
        for (int k = 0; k < probes; ++k) points.push_back(place(attacks[i], k));
      std::vector<float> values(points.size());
      field.values(points, values);
      for (std::int64_t i = begin; i < end; ++i) body(i, values.data() + (i - begin) * probes);
    });
  }

  /// Lifts a primitive that would dig into the platform before the cliff.
  std::vector<double> lifts(const field::CompiledField& field, const std::vector<Attack>& attacks,
                            double radius) const {
    constexpr int probes = 6;
    const double want = look::lift * radius;
    std::vector<double> lift(attacks.size(), 0.0);
    probe<probes>(
        field, attacks,
        [&](const Attack& a, int k) {
          return a.at.position + to_double(a.at.normal) * (look::lift_before * radius) -
                 Vec3d{0, 0, want * (k + 1) / probes};
        },
        [&](std::size_t i, const float* values) {
          const auto first = std::find_if(values, values + probes, [](float f) { return f > 0; });
          if (first != values + probes) lift[i] = want * (1 - ratio(first - values, probes));
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
          return a.at.position - horizontal(a.at.normal) * (look::neck * radius * (k + 1) / probes);
        },
        [&](std::size_t i, const float* values) {
          // The first probe may still lie in the air before a rough face.
          const auto air = std::find_if(values + 1, values + probes, [](float f) { return f <= 0; });
          if (air != values + probes)
            factor[i] = smoothstep(look::neck_thin, look::neck,
                                   look::neck * static_cast<double>(air - values) / probes);
        });
    return factor;
  }

  static Vec3d horizontal(Vec3f normal) {
    return normalized(Vec3d{to_double(normal).x, to_double(normal).y, 0});
  }

  field::NodePtr notch(std::int64_t step) {
    const field::CompiledField field = field::compile(tree_);
    const double scale = scale_of_step(step);
    const double radius = p_.radius * scale,
                 spacing = std::min(p_.spacing * scale, look::notch_spacing * radius);
    const auto attacks = sea_attacks(field, spacing, stream_of(Stream::steps, step));
    const auto lift = lifts(field, attacks, radius);
    const auto sound = strength(field, attacks, p_.radius);
    const double energy = share(p_.retreat, radius, spacing);
    field::CloudBuilder cloud{field::CloudSettings{}};
    Random random(ground_.site().seed, stream_of(Stream::step_sizes, step));
    for (std::size_t i = 0; i < attacks.size(); ++i) {
      const Attack& a = attacks[i];
      const double r = radius * random.uniform(look::notch_small, look::notch_large);
      // Waves drive inward: the sea undercuts even a face that leans back.
      const double effect = a.effect * sound[i];
      const Vec3d center = a.at.position + Vec3d{0, 0, lift[i]} -
                           horizontal(a.at.normal) * (look::notch_inward * r * std::sqrt(effect));
      if (effect < p_.threshold || !ground_.usable(center)) continue;
      add_point(cloud, center, r, -energy * effect * uneven(a.at.position, radius, Stream::unevenness));
      strongest_ = std::max(strongest_, a.effect);
    }
    primitives_ += cloud.size();
    return cloud.size() ? cloud.finish() : nullptr;
  }

  field::NodePtr caves() {
    const field::CompiledField field = field::compile(tree_);
    auto attacks = sea_attacks(field, p_.spacing, Stream::cave_mouths);
    std::erase_if(attacks, [this](const Attack& a) {
      return std::abs(a.at.position.z - sea_z_) > look::cave_band * p_.range ||
             std::abs(a.at.normal.z) > look::cave_level;
    });
    CaveSettings settings = p_;
    settings.sea_z = sea_z_;
    settings.seed = hash_combine(ground_.site().seed, Stream::caves);
    made_ = sea_caves(field, ground_, joints_, std::move(attacks), settings, progress_);
    if (made_.tubes.empty()) return nullptr;
    field::CloudBuilder cloud{field::CloudSettings{}};
    Random random(settings.seed, CaveStream::bores);
    for (const CaveTube& tube : made_.tubes) bore(cloud, tube, random);
    return cloud.size() ? cloud.finish() : nullptr;
  }

  /// A tube as a line of points, unevenly wide, so that its walls are not turned on a lathe.
  void bore(field::CloudBuilder& cloud, const CaveTube& tube, Random& random) {
    const double reach = look::bore_reach * tube.radius, step = look::bore_step * tube.radius;
    const double energy = tube_energy(ground_.site().amplitude, tube.radius, reach, step);
    const double span = length(tube.to - tube.from);
    const int n = std::max(1, round_to(span / step));
    for (int i = 0; i < n; ++i) {
      const double wobble = p_.roughness * tube.radius;
      const Vec3d jitter{random.uniform(-wobble, wobble), random.uniform(-wobble, wobble),
                         random.uniform(-wobble, wobble)};
      const Vec3d at = tube.from + (tube.to - tube.from) * ((i + 0.5) / n) + jitter;
      if (!ground_.usable(at)) continue;
      add_point(cloud, at, reach * random.uniform(look::bore_small, look::bore_large),
                -energy * span / (n * step));
      ++primitives_;
      pocket(cloud, at, tube.radius, random);
    }
  }

  /// The walls of caves recede where the bed is soft.
  void pocket(field::CloudBuilder& cloud, Vec3d at, double radius, Random& random) {
    const Vec3d d =
        normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(look::pocket_down, 1)});
    const Vec3d wall = at + d * (radius * random.uniform(look::pocket_near, look::pocket_far));
    const double soft = 1 - resistance(wall);
    if (soft < look::pocket_least || !ground_.usable(wall)) return;
    add_point(cloud, wall, radius * random.uniform(look::pocket_small, look::pocket_large),
              -look::pocket_strength * p_.roughness * ground_.site().amplitude * soft);
    ++primitives_;
  }

  Result report(Result result) const {
    result.facts.count("primitives", primitives_)
        .number("strongest_effect", strongest_)
        .about("Greatest erosion anywhere, from 0 for none to 1 for all that the parameters allow")
        .count("caves", std::ssize(made_.mouths))
        .about("Sea caves")
        .places("cave_positions", made_.mouths)
        .about("x, y and z of the mouth of each sea cave in turn")
        .count("arches", made_.arches)
        .about("Sea caves that go through a headland")
        .length("cave_passage", made_.length)
        .about("Length of all sea caves together");
    return result;
  }

  const Params& p_;
  Ground ground_;
  Joints joints_;
  double sea_z_;
  double gentle_;  ///< the normal's z above which ground is beach or platform
  field::NodePtr tree_;
  Progress& progress_;
  std::optional<impl::Shore> shore_;
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

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "sea-cliff",
                .doc = "Wave-cut notches, overhanging cliffs, sea caves and arches about the sea level",
                .source = "[Paris19 §6.1]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_sea_cliff
