#include <algorithm>
#include <array>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/landforms/spires/towers.h"
#include "tafoni/math/noise.h"

namespace tafoni::landforms {
namespace {

using impl::Ground;

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
              "most spires; points given to the layer are the feet of further ones")
        .real("height", &Params::height, "m", 0, 5000,
              "of a tall spire above its foot, 0 for eight pixels of the terrain but 40 m at least")
        .real("variation", &Params::variation, "", 0, 0.9, "share by which heights vary at random")
        .real("slenderness", &Params::slenderness, "", 1, 20, "height of a spire over its width")
        .real("spacing", &Params::spacing, "", 0.5, 50, "least distance between feet, in widths")
        .real("grouping", &Params::grouping, "", 0, 1, "how much they stand together in groves")
        .real("taper", &Params::taper, "", 0, 0.9, "share of the width that is lost towards the top")
        .real("slope", &Params::slope, "deg", 1, 90, "steepest ground that a spire stands on")
        .real("strata", &Params::strata, "", 0, 1, "how far soft beds recede")
        .real("roughness", &Params::roughness, "", 0, 1, "unevenness of the rock");
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
        random_(site.seed, 0x591) {
    height_ = p.height > 0 ? p.height : std::max(40.0, 8 * ground_.pixel());
    width_ = height_ / p.slenderness;
  }

  Result run() {
    if (!ground_.box().empty()) stand();
    Result result;
    std::vector<double> places, heights;
    for (const impl::Tower& tower : towers_) {
      const Vec3d world = tower.foot + ground_.site().origin;
      places.insert(places.end(), {world.x, world.y, world.z});
      heights.push_back(tower.height);
    }
    result.report = {{"spires", static_cast<std::int64_t>(towers_.size())},
                     {"positions", places},
                     {"heights_m", heights},
                     {"primitives", std::int64_t{0}}};
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
    t.relief = 0.2 * p_.strata * width_;
    t.unevenness = 0.12 * p_.roughness * width_;
    t.wavelength = 0.35 * width_;
    t.upright = 3.5;
    t.amplitude = ground_.site().amplitude;
    t.origin = ground_.site().origin;
    t.seed = hash_combine(ground_.site().seed, 0x7e);
    return t;
  }

  void stand() {
    SpatialHash apart(2 * p_.spacing * width_);
    for (Vec3d p : ground_.site().points)
      if (ground_.usable(p)) raise(p, apart);
    const Box3d& box = ground_.box();
    std::int64_t left = p_.count;
    progress_.begin("raising spires", static_cast<std::uint64_t>(p_.count), "spires");
    for (std::int64_t i = 0; left > 0 && i < 200 * p_.count; ++i) {
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
    if (!ground_.usable(p, 1.2 * width_) || room(p) < 0.3 * height_) return false;
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
    const Vec3d world = (p + ground_.site().origin) * (1 / (9 * width_));
    const double t = static_cast<double>(fbm({world.x, world.y, 0}, 2, hash_combine(ground_.site().seed, 3)));
    return 1 - p_.grouping + p_.grouping * smoothstep(0.48, 0.62, t);
  }

  bool steep(Vec3d p) const {
    const double d = 0.5 * width_;
    const double sx = ground_.height(p.x + d, p.y) - ground_.height(p.x - d, p.y);
    const double sy = ground_.height(p.x, p.y + d) - ground_.height(p.x, p.y - d);
    return std::hypot(sx, sy) > 2 * d * std::tan(p_.slope * 3.14159265358979323846 / 180);
  }

  /// A few blocks between the same two sets of joints, of different heights.
  void raise(Vec3d p, SpatialHash& apart) {
    apart.insert({p.x, p.y, 0});
    Random random(hash_combine(ground_.site().seed, 0x70), towers_.size());
    impl::Tower tower;
    tower.foot = p;
    tower.height = room(p) * (1 - p_.variation * random.uniform());
    const double stout = random.uniform();
    const double width =
        width_ * std::sqrt(tower.height / height_) * (0.7 + 0.5 * stout + 0.9 * std::pow(stout, 6.0));
    const double joint = 0.4 + 0.25 * random.uniform(-1, 1);
    const int blocks = 3 + static_cast<int>(random.below(4));
    for (int i = 0; i < blocks; ++i) {
      impl::Block block;
      const double part = i == 0 ? 1 : random.uniform(0.3, 0.98);
      const double out = i == 0 ? 0 : width * random.uniform(0.25, 0.6), around = random.uniform(0, 6.283);
      block.at = {p.x + out * std::cos(around), p.y + out * std::sin(around)};
      block.top = tower.height * part;
      block.turn = joint + random.uniform(-0.12, 0.12);
      const double half = 0.5 * width * (i == 0 ? 0.8 : random.uniform(0.3, 0.75));
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
      tower.blocks.push_back(block);
    }
    tower.sunk = 0.15 * tower.height + slope_drop(p, width);
    towers_.push_back(std::move(tower));
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

const LandformType& landform_spires() {
  static const LandformType type{
      .about = {.name = "spires",
                .doc = "Tall towers of bedded rock that stand between joints, singly and in groves",
                .source = "[Paris19 figs. 1, 20]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
