// Hoodoos: stands.h says where, growth.h grows each by rules that see the beds of bedding.h, and what has
// grown becomes one cloud for each kind of primitive, creased by a warp and blended into the terrain.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/hoodoos/bedding.h"
#include "tafoni/landforms/hoodoos/growth.h"
#include "tafoni/landforms/hoodoos/rules.h"
#include "tafoni/landforms/hoodoos/stands.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/table_rows.h"

namespace tafoni::landforms::landform_hoodoos {
namespace {

using impl::Ground;
using impl::Terminal;

/// Those of a hoodoo are counted on from `axioms`.
enum class Stream : std::uint64_t { axioms = 0x71, unevenness, creases };

/// Of the falloff beyond a solid: where g = 1/2, so that a solid of twice the terrain's amplitude ends there
/// in free air.
constexpr double half_falloff = 0.4542;

/// Of all hoodoos, before they go to clouds: half a gigabyte.
constexpr std::size_t most_solids = 4'000'000;

// Chosen by eye. Radii are those of a middling trunk.
constexpr double least_radius = 2.5, radius_in_pixels = 0.4;  // metres; slim enough to stand on one slope
constexpr double blend_share = 5, bed_share = 2;              // into how many parts of a radius
constexpr double roughness_in_radii = 0.06, roughness_waves = 0.8;  // at most; wavelength in radii
constexpr double roughness_room = 1.05;  // a solid's rounding leaves so much more than its unevenness takes
constexpr double slimmest = 0.65, stouter = 0.85, slim_ones = 1.6;  // radii, and how much more are slim
constexpr double crease_depth = 0.3, crease_width = 1.1, crease_height = 3, crease_up = 0.3;  // in radii

struct Params : impl::StandSettings {
  Params() = default;  // g++ 12 warns of vectors in the bases of aggregates
  double radius = 0;
  std::vector<double> height = {4, 8};
  std::vector<double> at;
  std::string axiom = "Hoodoo";
  double bedding = 0;
  double contrast = 0.35;
  double blend = 0;
  double creases = 0.5;
  double roughness = 0;
  Rows rule = impl::default_rules();
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("radius", &Params::radius, "m", 0, 200,
           "Half the width of a middling trunk, 0 for two fifths of a pixel of the terrain but 2.5 m at "
           "least")
        .numbers("height", &Params::height, "", 2, 0.1, 100,
                 "Least and greatest height over the ground, as multiples of the radius")
        .real("spacing", &Params::spacing, "m", 0, 2000,
              "Least distance from one to the next, 0 for three times the radius")
        .real("density", &Params::density, "", 0, 1,
              "Share of the best places that is taken, 0 for none but those that are given")
        .numbers("at", &Params::at, "m", 0, -1e9, 1e9,
                 "Places that are given besides the layer's points, x and y of each")
        .integer("count", &Params::count, "", 0, 1000000, "Most that grow besides those that are given")
        .numbers("slope", &Params::slope, "deg", 2, 0, 90,
                 "Least and greatest slope of the ground on which they stand")
        .real("ridges", &Params::ridges, "", 0, 1, "How far they keep to crests, 0 for not at all")
        .real("clusters", &Params::clusters, "", 0, 1, "How far they gather in groups, 0 for not at all")
        .real("catchment", &Params::catchment, "m", 0, 1e6,
              "Drainage area per metre of contour above which none stand, 0 for 120 m but 12 pixels at least")
        .real("river", &Params::river, "m", 0, 1e5,
              "They stand only within this distance of a river, 0 for anywhere")
        .real("river_area", &Params::river_area, "m2", 1, 1e12, "Drainage area that makes a river")
        .only("where river is above 0", {{"river", 40.0}})
        .text("axiom", &Params::axiom,
              "Symbol of the rules that each grows from: Hoodoo or Goblin, or one of yours")
        .real("bedding", &Params::bedding, "m", 0, 100,
              "Thickness of the beds that shape them, 0 for half the radius; thin ones make many necks")
        .real("contrast", &Params::contrast, "", 0, 1,
              "Most that a bed is harder or softer than the geology says; more makes deeper necks")
        .real("blend", &Params::blend, "m", 0, 100,
              "Width over which solids run into one another, 0 for a fifth of the radius")
        .real("creases", &Params::creases, "", 0, 1,
              "Depth of upright creases and other unevenness of the rock, 0 for none")
        .real("roughness", &Params::roughness, "", 0, 1,
              "Unevenness of each solid by itself, at a price in time; 0 for none")
        .rows("rule", &Params::rule, impl::rule_columns(), "The grammar that they grow by; see the manual");
    return t;
  }();
  return params;
}

class Hoodoos {
 public:
  Hoodoos(const Site& site, const Params& p, Progress& progress)
      : p_(p), ground_(site), rules_(p.rule, "hoodoos"), progress_(progress) {
    if (!rules_.has(p.axiom)) rules_.grow(p.axiom, {}, impl::Bedding(ground_, 1, 0));  // says so
    if (p.at.size() % 2 != 0) fail(ErrorKind::usage, "hoodoos: at must hold an x and a y for each place");
    if (p.height[0] > p.height[1] || p.slope[0] > p.slope[1])
      fail(ErrorKind::usage, "hoodoos: {} must not begin with the greater number",
           p.height[0] > p.height[1] ? "height" : "slope");
    radius_ = p.radius > 0 ? p.radius : std::max(least_radius, radius_in_pixels * ground_.pixel());
    blend_ = p.blend > 0 ? p.blend : radius_ / blend_share;
    bedding_ = p.bedding > 0 ? p.bedding : radius_ / bed_share;
    roughness_ = roughness_in_radii * p.roughness * radius_;
  }

  Result run() {
    if (ground_.box().empty()) return finish({}, {});
    const std::vector<Vec3d> feet = places();
    const impl::Bedding rock(ground_, bedding_, p_.contrast);
    std::vector<std::vector<Terminal>> grown(feet.size());
    progress_.begin("hoodoos", feet.size(), "hoodoos");
    // All of them together; whether they are too many does not depend on which is grown first.
    std::atomic<std::size_t> solids = 0;
    parallel_for(
        std::ssize(feet),
        [&](std::int64_t k) {
          grown[k] = rules_.grow(p_.axiom, axiom(feet[k], k), rock);
          if ((solids += grown[k].size()) > most_solids)
            fail(ErrorKind::usage,
                 "hoodoos: {} of them have more than {} million shapes together; give a smaller density or "
                 "count, or rules that make fewer",
                 feet.size(), most_solids / 1'000'000);
        },
        progress_);
    progress_.end();
    return finish(feet, grown);
  }

 private:
  /// The user's points come first.
  std::vector<Vec3d> places() {
    std::vector<Vec3d> all;
    const auto add = [&](Vec3d p) {
      p.z = ground_.height(p.x, p.y);
      if (ground_.usable(p)) all.push_back(p);
    };
    for (const Vec3d p : ground_.site().points) add(p);
    const std::ptrdiff_t before = std::ssize(all), given = std::ssize(p_.at) / 2;
    for (std::ptrdiff_t i = 0; i < given; ++i)
      add(Vec3d{p_.at[2 * i], p_.at[2 * i + 1], 0} - ground_.site().origin);
    impl::warn_of_left_out("hoodoos: at", std::ssize(all) - before, given, progress_);
    if (p_.density == 0) return all;
    const auto found = impl::Stands(ground_, p_, radius_, progress_).places(all);
    all.insert(all.end(), found.begin(), found.end());
    return all;
  }

  /// Begins below the lowest ground about the foot, so that no gap shows on a slope.
  impl::Axiom axiom(Vec3d foot, std::size_t index) const {
    Random random(hash_combine(ground_.site().seed, Stream::axioms), index);
    impl::Axiom axiom;
    axiom.radius = radius_ * (slimmest + stouter * std::pow(random.uniform(), slim_ones));
    axiom.height = radius_ * random.uniform(p_.height[0], p_.height[1]);
    axiom.turn = random.uniform(0, 2 * std::numbers::pi);
    axiom.skin = half_falloff * blend_;
    axiom.datum = ground_.site().origin.z;
    axiom.seed = random.next();
    double lowest = foot.z;
    for (int k = 0; k < 8; ++k) {
      const double a = std::numbers::pi / 4 * k;
      lowest = std::min(
          lowest, ground_.height(foot.x + axiom.radius * std::cos(a), foot.y + axiom.radius * std::sin(a)));
    }
    axiom.position = {foot.x, foot.y, lowest};
    return axiom;
  }

  Result finish(const std::vector<Vec3d>& feet, const std::vector<std::vector<Terminal>>& grown) const {
    std::map<std::string, field::CloudBuilder> clouds;
    double highest = 0;
    for (std::size_t k = 0; k < grown.size(); ++k)
      for (const Terminal& t : grown[k]) {
        auto found = clouds.find(t.kind->about.name);
        if (found == clouds.end())
          found = clouds.emplace(t.kind->about.name, cloud(t.kind->about.name)).first;
        std::vector<float> shape(t.shape.begin(), t.shape.begin() + t.kind->about.params.size());
        shape[0] = std::max(shape[0], static_cast<float>(roughness_room * roughness_));
        found->second.add(t.position, static_cast<float>(2 * ground_.site().amplitude * t.energy), shape);
        highest = std::max(highest, t.position.z - feet[k].z);
      }
    Result result;
    std::int64_t primitives = 0;
    std::vector<field::NodePtr> solids;
    for (auto& [kind, builder] : clouds) {
      primitives += builder.size();
      solids.push_back(builder.finish());
    }
    if (!solids.empty()) result.nodes.push_back(crease(field::blend(std::move(solids))));
    result.facts.count("hoodoos", std::ssize(feet))
        .about("Hoodoos that grew")
        .count("primitives", primitives)
        .length("greatest_height", highest)
        .about("Height of the tallest hoodoo above its foot")
        .places("positions", feet)
        .about("x, y and z of the foot of each hoodoo in turn");
    return result;
  }

  /// Upright creases and cracks [Paris19 fig. 5]: a warp of short lateral wavelength.
  field::NodePtr crease(field::NodePtr rock) const {
    if (p_.creases == 0) return rock;
    field::WarpSettings warp;
    const double depth = crease_depth * p_.creases * radius_;
    warp.amplitude = {depth, depth, crease_up * depth};
    warp.lateral = crease_width * radius_;
    warp.vertical = crease_height * radius_;
    warp.octaves = 2;
    warp.seed = hash_combine(ground_.site().seed, Stream::creases);
    return field::warp(std::move(rock), nullptr, warp);
  }

  field::CloudBuilder cloud(const std::string& kind) const {
    field::CloudSettings settings;
    settings.kind = kind;
    settings.falloff = blend_;
    settings.noise = {roughness_, roughness_waves * radius_, 3,
                      hash_combine(ground_.site().seed, Stream::unevenness)};
    return field::CloudBuilder(settings);
  }

  const Params& p_;
  Ground ground_;
  impl::GrowthRules rules_;
  Progress& progress_;
  double radius_, blend_, bedding_, roughness_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "hoodoos");
  return Hoodoos(site, p, progress).run();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "hoodoos",
                .doc = "Pillars of bedded rock with necks where it is soft and caps where it is hard",
                .source = "[Paris19 §6.3]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_hoodoos
