// Spires: places on gentle ground, in groves by noise, each a tower of a few blocks between the same two sets
// of joints. towers.h makes one solid of all, in the scene a union with the terrain.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/landforms/spires/towers.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::landforms::landform_spires {
namespace {

using impl::Ground;

/// Those of a tower are counted on from `towers`.
enum class Stream : std::uint64_t { groves = 3, towers = 0x70, texture = 0x7e, places = 0x591 };

// Chosen by eye; widths and heights are those of a tall spire.
constexpr double least_height = 40,
                 height_in_pixels = 8;  // metres; what the raster shows as ground around it
constexpr double relief = 0.2, unevenness = 0.12, wavelength = 0.35;  // widths: of the rock's texture
constexpr double upright = 3.5;     // the texture is so many times longer upward than sideways
constexpr int most_tries = 200;     // for each spire that is wanted
constexpr double clear = 1.2;       // widths kept to missing data and to the outline
constexpr double least_room = 0.3;  // of the height, below the limit of the region
constexpr double grove_size = 9;    // widths
constexpr double grove_from = 0.48, grove_to = 0.62;  // noise outside of groves and within them
constexpr double slim = 0.7, stouter = 0.5, stoutest = 0.9, few_stout = 6;  // widths; few are much stouter
constexpr int fewest_blocks = 3;
constexpr std::uint64_t more_blocks = 4;
constexpr double joint_turn = 0.4, joint_spread = 0.25, block_spread = 0.12;  // radians
constexpr double sunk_share = 0.15;  // of a tower's height, below the lowest ground about it

struct Params {
  std::int64_t count = 30;
  double height = 0;
  double variation = 0.5;
  double slenderness = 5;
  double spacing = 1.2;
  double grouping = 0.6;
  double taper = 0.35;
  double slope = 35;
  double strata = 0.5;
  double roughness = 0.5;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 100000,
              "Most spires; points given to the layer are the feet of further ones")
        .real("height", &Params::height, "m", 0, 5000,
              "Height of a tall spire above its foot, 0 for eight pixels of the terrain but 40 m at least")
        .real("variation", &Params::variation, "", 0, 0.9,
              "Share by which heights vary at random, 0 for spires of one height")
        .real("slenderness", &Params::slenderness, "", 1, 20,
              "Height of a spire over its width; more makes needles")
        .real("spacing", &Params::spacing, "", 0.5, 50, "Least distance between feet, in widths")
        .real("grouping", &Params::grouping, "", 0, 1,
              "How much they stand together in groves, 0 for evenly spread")
        .real("taper", &Params::taper, "", 0, 0.9,
              "Share of the width that is lost towards the top, 0 for upright walls")
        .real("slope", &Params::slope, "deg", 1, 90, "Steepest ground that a spire stands on")
        .real("strata", &Params::strata, "", 0, 1, "How far soft beds recede, 0 for not at all")
        .real("roughness", &Params::roughness, "", 0, 1, "Unevenness of the rock, 0 for flat faces");
    return t;
  }();
  return params;
}

class Spires {
 public:
  Spires(const Site& site, const Params& p, Progress& progress)
      : p_(p),
        ground_(site),
        field_(field::compile(site.terrain)),
        progress_(progress),
        random_(site.seed, Stream::places) {
    height_ = p.height > 0 ? p.height : std::max(least_height, height_in_pixels * ground_.pixel());
    width_ = height_ / p.slenderness;
  }

  Result run() {
    if (!ground_.box().empty()) stand();
    Result result;
    std::vector<Vec3d> feet;
    std::vector<double> heights;
    for (const impl::Tower& tower : towers_) {
      feet.push_back(tower.foot);
      heights.push_back(tower.height);
    }
    result.facts.count("spires", std::ssize(towers_))
        .about("Towers of rock")
        .places("positions", std::move(feet))
        .about("x, y and z of the foot of each spire in turn")
        .lengths("heights", std::move(heights))
        .about("Height of each spire above its foot")
        .count("primitives", 0);
    if (towers_.empty()) return result;
    const auto forest = std::make_shared<const impl::Towers>(towers_, texture());
    result.reshaped = forest->box();
    result.reshape = [solid = field::function(forest)](field::NodePtr tree) {
      return field::unite({std::move(tree), solid});
    };
    return result;
  }

 private:
  impl::RockTexture texture() const {
    impl::RockTexture t;
    t.geology = ground_.site().geology;
    t.relief = relief * p_.strata * width_;
    t.unevenness = unevenness * p_.roughness * width_;
    t.wavelength = wavelength * width_;
    t.upright = upright;
    t.amplitude = ground_.site().amplitude;
    t.origin = ground_.site().origin;
    t.seed = hash_combine(ground_.site().seed, Stream::texture);
    return t;
  }

  void stand() {
    SpatialHash apart(2 * p_.spacing * width_);
    for (Vec3d p : ground_.site().points)
      if (ground_.usable(p)) raise(p, apart);
    const Box3d& box = ground_.box();
    std::int64_t left = p_.count;
    progress_.begin("raising spires", p_.count, "spires");
    for (std::int64_t i = 0; left > 0 && i < most_tries * p_.count; ++i) {
      progress_.check();
      Vec3d p{random_.uniform(box.lo.x, box.hi.x), random_.uniform(box.lo.y, box.hi.y), 0};
      p.z = ground_.height(p.x, p.y);
      const double chance = random_.uniform();
      if (chance > grove(p) || !free(p) || steep(p)) continue;
      if (apart.any_near({p.x, p.y, 0}, p_.spacing * width_)) continue;
      raise(p, apart);
      progress_.advance();
      --left;
    }
    progress_.end();
  }

  /// The site reaches on all sides as far as a spire.
  bool free(Vec3d p) const {
    if (!ground_.usable(p, clear * width_) || room(p) < least_room * height_) return false;
    for (const Vec3d d : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}})
      if (!ground_.usable(p + d * width_)) return false;
    return true;
  }

  /// Height up to the limit of the region.
  double room(Vec3d p) const {
    const Region* region = ground_.site().region;
    return region ? std::min(height_, region->bounds().hi.z - p.z) : height_;
  }

  /// Chance of standing here, 1 in the middle of a grove.
  double grove(Vec3d p) const {
    const Vec3d world = (p + ground_.site().origin) * (1 / (grove_size * width_));
    const double t = fbm({world.x, world.y, 0}, 2, hash_combine(ground_.site().seed, Stream::groves));
    return 1 - p_.grouping + p_.grouping * smoothstep(grove_from, grove_to, t);
  }

  bool steep(Vec3d p) const {
    const double d = 0.5 * width_;
    const double sx = ground_.height(p.x + d, p.y) - ground_.height(p.x - d, p.y);
    const double sy = ground_.height(p.x, p.y + d) - ground_.height(p.x, p.y - d);
    return std::hypot(sx, sy) > 2 * d * std::tan(p_.slope * std::numbers::pi / 180);
  }

  /// A few blocks between the same two sets of joints, of different heights.
  void raise(Vec3d p, SpatialHash& apart) {
    apart.insert({p.x, p.y, 0});
    Random random(hash_combine(ground_.site().seed, Stream::towers), towers_.size());
    impl::Tower tower;
    tower.foot = p;
    tower.height = room(p) * (1 - p_.variation * random.uniform());
    const double stout = random.uniform();
    const double width = width_ * std::sqrt(tower.height / height_) *
                         (slim + stouter * stout + stoutest * std::pow(stout, few_stout));
    const double joint = joint_turn + joint_spread * random.uniform(-1, 1);
    const int blocks = fewest_blocks + draw_index(random, more_blocks);
    for (int i = 0; i < blocks; ++i) {
      tower.blocks.push_back(make_block(p, tower.height, width, joint, i == 0, random));
    }
    tower.sunk = sunk_share * tower.height + slope_drop(p, width);
    towers_.push_back(std::move(tower));
  }

  /// The first block is the tower's own; the others stand against it, lower and slimmer.
  impl::Block make_block(Vec3d p, double height, double width, double joint, bool first,
                         Random& random) const {
    impl::Block block;
    const double part = first ? 1 : random.uniform(0.3, 0.98);
    const double out = first ? 0 : width * random.uniform(0.25, 0.6), around = random.uniform(0, 6.283);
    block.at = {p.x + out * std::cos(around), p.y + out * std::sin(around)};
    block.top = height * part;
    block.turn = joint + random.uniform(-block_spread, block_spread);
    const double half = 0.5 * width * (first ? 0.8 : random.uniform(0.3, 0.75));
    block.half = {half * random.uniform(0.65, 1.35), half * random.uniform(0.65, 1.35)};
    block.cut = random.uniform(0.05, 0.45) * std::min(block.half.x, block.half.y);
    block.lean = {random.uniform(-0.035, 0.035), random.uniform(-0.035, 0.035)};
    block.tilt = {random.uniform(-0.35, 0.35), random.uniform(-0.35, 0.35)};
    // It narrows by steps, where a bed gave way.
    double left = 1;
    for (double& w : block.widths) {
      w = left;
      left *= 1 - p_.taper * random.uniform(0, 2.0) / static_cast<double>(block.widths.size());
    }
    return block;
  }

  /// How far the ground falls away within the width.
  double slope_drop(Vec3d p, double width) const {
    double least = p.z;
    for (const Vec2d d : {Vec2d{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      least = std::min(least, ground_.height(p.x + d.x * width, p.y + d.y * width));
    return p.z - least;
  }

  const Params& p_;
  Ground ground_;
  field::CompiledField field_;
  Progress& progress_;
  Random random_;
  double height_, width_;
  std::vector<impl::Tower> towers_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "spires");
  return Spires(site, p, progress).run();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "spires",
                .doc = "Tall towers of bedded rock that stand between joints, singly and in groves",
                .source = "[Paris19 figs. 1, 20]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_spires
