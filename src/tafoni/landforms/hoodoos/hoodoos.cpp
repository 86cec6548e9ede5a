#include <algorithm>
#include <cmath>
#include <map>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/hoodoos/bedding.h"
#include "tafoni/landforms/hoodoos/grammar.h"
#include "tafoni/landforms/hoodoos/stands.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms {
namespace {

using impl::Ground;
using impl::Terminal;

/// Of the falloff beyond a solid: where g = 1/2, so that a solid of twice the terrain's amplitude ends there
/// in free air.
constexpr double half_falloff = 0.4542;

Rows default_rules() {
  return {
      // a: phase of the flutes, b: their number, c: narrowing toward the top.
      {{"symbol", "Hoodoo"},
       {"make", "Foot(); Trunk(a = random(0, 360), b = floor(random(3, 6)), c = random(0.45, 0.75))"}},
      {{"symbol", "Foot"},
       {"make",
        "cone(z = -s, dz = 1.7*s, base = 2*s, tip = 0.6*s, x = random(-0.3, 0.3)*s); "
        "cone(repeat = 3, turn = random(0, 360), x = 0.9*s, z = -s, dz = random(1.1, 1.6)*s, base = 1.3*s, "
        "tip = 0.3*s)"}},
      {{"symbol", "Trunk"},
       {"weight", "h < height && !(h > 0.7*height && rho > 0.6)"},
       {"make",
        "Bed(s = s*(1.3 - c*h/height)*(0.28 + 0.8*rho)); "
        "Trunk(z = bed, x = random(-0.06, 0.06)*s, y = random(-0.06, 0.06)*s)"}},
      {{"symbol", "Trunk"},
       {"weight", "h >= height || (h > 0.7*height && rho > 0.6)"},
       {"make", "Cap(s = s*(1.3 - c))"}},
      {{"symbol", "Bed"},
       {"make",
        "cylinder(base = max(0.66*s, 0.32*radius) - skin, dz = bed, radius = 0.15); "
        "cylinder(repeat = b, turn = 360*i/n, x = 0.58*s, z = 0.2*bed, dz = 0.6*bed, radius = 0.15,"
        " base = s*(0.4 + 0.12*sin(a + 97*i)) - skin)"}},
      {{"symbol", "Cap"},
       {"weight", "rho"},
       {"make",
        "cylinder(base = 0.5*s, dz = bed); "
        "box(repeat = 2, z = 0.6*bed, hx = s*random(0.6, 0.9), hy = s*random(0.5, 0.7), hz = 0.3*bed, turn = "
        "random(0, 180))"}},
      {{"symbol", "Cap"},
       {"weight", "1 - rho"},
       {"make",
        "cylinder(base = 0.4*s, dz = bed); ellipsoid(z = bed, hx = 0.6*s, hy = 0.5*s, hz = 0.6*bed, turn = "
        "random(0, 180))"}},
      // Squat, with a broad head.
      {{"symbol", "Goblin"},
       {"make", "cone(z = -s, dz = 1.3*s, base = 1.5*s, tip = 0.6*s); Stem(a = random(0, 360))"}},
      {{"symbol", "Stem"},
       {"weight", "h < 0.5*height"},
       {"make",
        "cylinder(base = 0.4*s - skin, dz = bed, radius = 0.15); "
        "ellipsoid(z = 0.5*bed, hx = s*(0.35 + 0.5*rho), hy = s*(0.3 + 0.45*rho), hz = 0.5*bed, radius = "
        "0.15, turn = a); "
        "Stem(z = bed, x = random(-0.1, 0.1)*s)"}},
      {{"symbol", "Stem"}, {"weight", "h >= 0.5*height"}, {"make", "Head(z = 0.2*s)"}},
      {{"symbol", "Head"},
       {"weight", "rho"},
       {"make",
        "cylinder(z = -0.3*s, base = 0.4*s - skin, dz = 0.6*s); "
        "ellipsoid(z = 0.15*s, hx = s*random(0.9, 1.2), hy = s*random(0.7, 0.9), hz = 0.4*s, turn = a); "
        "ellipsoid(repeat = 2, turn = a + 180*i + random(-40, 40), x = 0.5*s, z = random(0, 0.4)*s, hx = "
        "0.6*s,"
        " hy = 0.6*s, hz = 0.3*s)"}},
      {{"symbol", "Head"},
       {"weight", "1 - rho"},
       {"make",
        "ellipsoid(hx = s*random(0.75, 0.95), hy = s*random(0.6, 0.8), hz = 0.45*s, turn = a); "
        "cylinder(base = 0.35*s - skin, dz = 0.7*s); "
        "ellipsoid(z = 0.75*s, x = random(-0.15, 0.15)*s, hx = s*random(0.5, 0.7), hy = 0.5*s, hz = 0.35*s, "
        "turn = random(0, 180))"}},
  };
}

struct Params {
  double radius = 0;
  std::vector<double> height = {4, 8};
  double spacing = 0;
  double density = 1;
  std::int64_t count = 2000;
  std::vector<double> at;
  std::vector<double> slope = {14, 60};
  double ridges = 0.5;
  double clusters = 0.5;
  double catchment = 0;
  double river = 0;
  double river_area = 20000;
  std::string axiom = "Hoodoo";
  double bedding = 0;
  double contrast = 0.35;
  double blend = 0;
  double creases = 0.5;
  double roughness = 0;
  Rows rule = default_rules();
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real(
         "radius", &Params::radius, "m", 0, 200,
         "half the width of a middling trunk, 0 for two fifths of a pixel of the terrain but 2.5 m at least")
        .numbers("height", &Params::height, "", 2, 0.1, 100,
                 "least and greatest height over the ground, as multiples of the radius")
        .real("spacing", &Params::spacing, "m", 0, 2000,
              "least distance from one to the next, 0 for three times the radius")
        .real("density", &Params::density, "", 0, 1,
              "share of the best places that is taken, 0 for none but those that are given")
        .numbers("at", &Params::at, "m", 0, -1e9, 1e9,
                 "x and y of places that are given, as many as wanted, besides the layer's points")
        .integer("count", &Params::count, "", 0, 1000000, "most that grow")
        .numbers("slope", &Params::slope, "deg", 2, 0, 90, "slopes of the ground on which they stand")
        .real("ridges", &Params::ridges, "", 0, 1, "how far they keep to crests, 0 for not at all")
        .real("clusters", &Params::clusters, "", 0, 1, "how far they gather in groups, 0 for not at all")
        .real("catchment", &Params::catchment, "m", 0, 1e6,
              "drainage area per metre of contour above which none stand, 0 for 120 m but 12 pixels at least")
        .real("river", &Params::river, "m", 0, 1e5,
              "they stand only within this distance of a river, 0 for anywhere")
        .real("river_area", &Params::river_area, "m2", 1, 1e12, "drainage area that makes a river")
        .text("axiom", &Params::axiom, "symbol that each grows from")
        .real("bedding", &Params::bedding, "m", 0, 100,
              "thickness of the beds that shape them, 0 for half the radius")
        .real("contrast", &Params::contrast, "", 0, 1,
              "most that a bed is harder or softer than the geology says")
        .real("blend", &Params::blend, "m", 0, 100,
              "over which solids run into one another, 0 for a fifth of the radius")
        .real("creases", &Params::creases, "", 0, 1,
              "depth of upright creases and other unevenness of the rock")
        .real("roughness", &Params::roughness, "", 0, 1, "unevenness of each solid by itself, at a price")
        .rows("rule", &Params::rule, impl::rule_columns(), "the grammar that they grow by; see the manual");
    return t;
  }();
  return params;
}

class Hoodoos {
 public:
  Hoodoos(const Site& site, const Params& p, Progress& progress)
      : p_(p), ground_(site), grammar_(p.rule, "hoodoos"), progress_(progress) {
    if (!grammar_.has(p.axiom)) grammar_.grow(p.axiom, {}, impl::Bedding(ground_, 1, 0));
    if (p.at.size() % 2 != 0) fail(ErrorKind::usage, "hoodoos: at must hold an x and a y for each place");
    if (p.height[0] > p.height[1] || p.slope[0] > p.slope[1])
      fail(ErrorKind::usage, "hoodoos: {} must not begin with the greater number",
           p.height[0] > p.height[1] ? "height" : "slope");
    radius_ = p.radius > 0 ? p.radius : std::max(2.5, 0.4 * ground_.pixel());
    blend_ = p.blend > 0 ? p.blend : radius_ / 5;
    bedding_ = p.bedding > 0 ? p.bedding : radius_ / 2;
    roughness_ = 0.06 * p.roughness * radius_;
  }

  Result run() {
    if (ground_.box().empty()) return finish({}, {});
    const std::vector<Vec3d> feet = places();
    const impl::Bedding rock(ground_, bedding_, p_.contrast);
    std::vector<std::vector<Terminal>> grown(feet.size());
    progress_.begin("hoodoos", feet.size(), "hoodoos");
    parallel_for(
        static_cast<std::int64_t>(feet.size()),
        [&](std::int64_t i) {
          const auto k = static_cast<std::size_t>(i);
          grown[k] = grammar_.grow(p_.axiom, axiom(feet[k], k), rock);
        },
        progress_);
    progress_.end();
    return finish(feet, grown);
  }

 private:
  /// The user's points come first.
  std::vector<Vec3d> places() {
    std::vector<Vec3d> all;
    std::vector<Vec3d> given = ground_.site().points;
    for (std::size_t i = 0; i + 1 < p_.at.size(); i += 2)
      given.push_back(Vec3d{p_.at[i], p_.at[i + 1], 0} - ground_.site().origin);
    for (Vec3d p : given) {
      p.z = ground_.height(p.x, p.y);
      if (ground_.usable(p)) all.push_back(p);
    }
    if (p_.density == 0) return all;
    impl::StandSettings stand;
    stand.spacing = p_.spacing > 0 ? p_.spacing : 3 * radius_;
    stand.across = 3 * radius_;
    stand.margin = 2.5 * radius_;
    stand.density = p_.density;
    stand.slope_from = p_.slope[0];
    stand.slope_to = p_.slope[1];
    stand.ridges = p_.ridges;
    stand.clusters = p_.clusters;
    stand.catchment = p_.catchment > 0 ? p_.catchment : std::max(120.0, 12 * ground_.pixel());
    stand.river = p_.river;
    stand.river_area = p_.river_area;
    stand.most = static_cast<std::size_t>(p_.count);
    stand.seed = hash_combine(ground_.site().seed, 0x70);
    const auto found = impl::Stands(ground_, stand, progress_).places(all);
    all.insert(all.end(), found.begin(), found.end());
    return all;
  }

  /// Begins below the lowest ground about the foot, so that no gap shows on a slope.
  impl::Axiom axiom(Vec3d foot, std::size_t index) const {
    Random random(hash_combine(ground_.site().seed, 0x71), index);
    impl::Axiom axiom;
    // Many slim ones, few stout ones.
    axiom.radius = radius_ * (0.65 + 0.85 * std::pow(random.uniform(), 1.6));
    axiom.height = radius_ * random.uniform(p_.height[0], p_.height[1]);
    axiom.turn = random.uniform(0, 6.283185307179586);
    axiom.skin = half_falloff * blend_;
    axiom.datum = ground_.site().origin.z;
    axiom.seed = random.next();
    double lowest = foot.z;
    for (int k = 0; k < 8; ++k) {
      const double a = 0.7853981633974483 * k;
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
        std::vector<float> shape(t.shape.begin(),
                                 t.shape.begin() + static_cast<std::ptrdiff_t>(t.kind->about.params.size()));
        shape[0] = std::max(shape[0], static_cast<float>(1.05 * roughness_));
        found->second.add(t.position, static_cast<float>(2 * ground_.site().amplitude * t.energy), shape);
        highest = std::max(highest, t.position.z - feet[k].z);
      }
    Result result;
    std::int64_t primitives = 0;
    std::vector<field::NodePtr> solids;
    for (auto& [kind, builder] : clouds) {
      primitives += static_cast<std::int64_t>(builder.size());
      solids.push_back(builder.finish());
    }
    if (!solids.empty()) result.nodes.push_back(creased(field::blend(std::move(solids))));
    std::vector<double> positions;
    for (const Vec3d p : feet)
      for (double v :
           {p.x + ground_.site().origin.x, p.y + ground_.site().origin.y, p.z + ground_.site().origin.z})
        positions.push_back(v);
    result.report = {{"hoodoos", static_cast<std::int64_t>(feet.size())},
                     {"primitives", primitives},
                     {"greatest_height_m", highest},
                     {"positions", positions}};
    return result;
  }

  /// Upright creases and cracks [Paris19 fig. 5]: a warp of short lateral wavelength.
  field::NodePtr creased(field::NodePtr rock) const {
    if (p_.creases == 0) return rock;
    field::WarpSettings warp;
    const double depth = 0.3 * p_.creases * radius_;
    warp.amplitude = {depth, depth, 0.3 * depth};
    warp.lateral = 1.1 * radius_;
    warp.vertical = 3 * radius_;
    warp.octaves = 2;
    warp.seed = hash_combine(ground_.site().seed, 0x73);
    return field::warp(std::move(rock), nullptr, warp);
  }

  field::CloudBuilder cloud(const std::string& kind) const {
    field::CloudSettings settings;
    settings.kind = kind;
    settings.falloff = blend_;
    settings.noise = {roughness_, 0.8 * radius_, 3, hash_combine(ground_.site().seed, 0x72)};
    return field::CloudBuilder(settings);
  }

  const Params& p_;
  Ground ground_;
  impl::Grammar grammar_;
  Progress& progress_;
  double radius_, blend_, bedding_, roughness_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "hoodoos");
  return Hoodoos(site, p, progress).run();
}

}  // namespace

const LandformType& landform_hoodoos() {
  static const LandformType type{
      .about = {.name = "hoodoos",
                .doc = "Pillars of bedded rock with necks where it is soft and caps where it is hard",
                .source = "[Paris19 §6.3]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
