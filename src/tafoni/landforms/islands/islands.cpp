// Floating islands: where they hang and how large they are. island.h makes each; the tree is a union with
// them.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/islands/island.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms::landform_islands {
namespace {

using impl::Ground;
using impl::Island;

enum class Stream : std::uint64_t { places = 0x151 };

// Chosen by eye; shares of an island's size unless said otherwise.
constexpr double size_share = 0.25;              // of the terrain's shorter side
constexpr double height_in_sizes = 1.3;          // high enough that roots hang free
constexpr double lowest = 0.75, highest = 1.25;  // of the mean height over the ground
constexpr int most_tries = 60;                   // for each island that is wanted
constexpr double below_roots = 1.1;              // of the depth: roots reach a little deeper at random
constexpr double rim_share = 0.6;                // where an island must not leave the site, at
constexpr int rim_places = 12;                   // so many places
constexpr double strata_share = 0.015;           // how far soft beds recede by themselves
constexpr double strata_most = 0.75;             // of the terrain's amplitude: beyond it rock would break up

struct Params : impl::IslandSettings {
  std::int64_t count = 6;
  double size = 0;
  double variation = 0.35;
  double height = 0;
  double spacing = 1.5;
  double strata = 0;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 1000,
              "Most islands; points given to the layer are the middles of further ones")
        .real("size", &Params::size, "m", 0, 20000,
              "Mean width of an island, 0 for a quarter of the terrain's shorter side")
        .real("variation", &Params::variation, "", 0, 0.8,
              "Share by which sizes vary at random, 0 for islands of one size")
        .real("height", &Params::height, "m", 0, 20000,
              "How high the tops lie above the ground on average, 0 for 1.3 times the size")
        .real("depth", &Params::depth, "", 0.05, 3, "How deep the roots hang, as a share of the size")
        .real("relief", &Params::relief, "", 0, 1,
              "Height of the hills on top, as a share of the size, 0 for a flat top")
        .real("spacing", &Params::spacing, "", 0.5, 20,
              "Least distance between middles, as a multiple of the mean of the two sizes")
        .real("roots", &Params::roots, "", 0, 1,
              "How much the underside is split into hanging roots, 0 for a smooth bowl")
        .real("strata", &Params::strata, "m", 0, 100,
              "How far soft beds recede, 0 for 1.5 % of the size; at most three quarters of the terrain's "
              "amplitude");
    return t;
  }();
  return params;
}

/// Where the islands float: the user's points first, then at random over the site.
class Placing {
 public:
  Placing(const Ground& ground, const Params& p)
      : ground_(ground), p_(p), random_(ground.site().seed, Stream::places) {
    const Vec3d extent = ground.box().size();
    mean_ = p.size > 0 ? p.size : size_share * std::min(extent.x, extent.y);
    height_ = p.height > 0 ? p.height : height_in_sizes * mean_;
  }

  std::vector<Island> run() {
    for (Vec3d at : ground_.site().points)
      if (ground_.usable(at)) islands_.push_back({at, size(), random_.next()});
    const Box3d& box = ground_.box();
    const std::size_t most = islands_.size() + p_.count;
    for (std::int64_t i = 0; islands_.size() < most && i < most_tries * p_.count; ++i) {
      Island island{{random_.uniform(box.lo.x, box.hi.x), random_.uniform(box.lo.y, box.hi.y), 0},
                    size(),
                    random_.next()};
      Vec3d& p = island.middle;
      p.z = ground_.height(p.x, p.y) + height_ * random_.uniform(lowest, highest);
      fit(island);
      if (clear(island)) islands_.push_back(island);
    }
    return std::move(islands_);
  }

 private:
  double size() { return mean_ * (1 + p_.variation * random_.uniform(-1, 1)); }

  /// Where the region is limited in height, the island hangs within its limits.
  void fit(Island& island) const {
    if (!ground_.site().region) return;
    const Box3d limit = ground_.site().region->bounds();
    const double above = p_.relief * island.size, below = below_roots * p_.depth * island.size;
    island.middle.z = std::max(std::min(island.middle.z, limit.hi.z - above), limit.lo.z + below);
  }

  bool clear(const Island& island) const {
    if (!ground_.usable(island.middle)) return false;
    for (int i = 0; i < rim_places; ++i) {
      const double a = full_turn * i / rim_places;
      const Vec3d rim = island.middle + Vec3d{std::cos(a), std::sin(a), 0} * (rim_share * island.size);
      if (!ground_.usable(rim)) return false;
    }
    return std::none_of(islands_.begin(), islands_.end(), [&](const Island& other) {
      const Vec3d d = other.middle - island.middle;
      return std::hypot(d.x, d.y) < 0.5 * p_.spacing * (island.size + other.size);
    });
  }

  const Ground& ground_;
  const Params& p_;
  Random random_;
  double mean_, height_;
  std::vector<Island> islands_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "islands");
  const Ground ground(site);
  const std::vector<Island> islands = ground.box().empty() ? std::vector<Island>{} : Placing(ground, p).run();
  std::vector<impl::IslandTree> made(islands.size());
  progress.begin("raising islands", islands.size(), "islands");
  parallel_for(
      std::ssize(islands), [&](std::int64_t i) { made[i] = impl::make_island(ground, islands[i], p); },
      progress);
  progress.end();
  progress.check();
  Result result;
  std::vector<Vec3d> places;
  std::vector<double> sizes;
  for (const Island& island : islands) {
    places.push_back(island.middle);
    sizes.push_back(island.size);
  }
  result.facts.count("islands", std::ssize(islands))
      .about("Islands that float")
      .places("positions", std::move(places))
      .about("x, y and z of the middle of each island in turn")
      .lengths("sizes", std::move(sizes))
      .about("Width of each island")
      .count("primitives", 0);
  if (islands.empty()) return result;
  std::vector<field::NodePtr> trees;
  for (std::size_t i = 0; i < made.size(); ++i) {
    result.reshaped.expand(made[i].changed);
    field::NodePtr tree = std::move(made[i].tree);
    if (site.geology) {
      const double depth = p.strata > 0 ? p.strata : strata_share * islands[i].size;
      tree = field::erode(std::move(tree), nullptr, geology::as_function(site.geology),
                          std::min(depth, strata_most * site.amplitude));
    }
    trees.push_back(std::move(tree));
  }
  result.reshape = [trees](field::NodePtr tree) {
    std::vector<field::NodePtr> all = {std::move(tree)};
    all.insert(all.end(), trees.begin(), trees.end());
    return field::unite(std::move(all));
  };
  return result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "islands",
                .doc = "Floating islands: each the rock between a piece of terrain and an inverted one",
                .source = "[Paris19 §5.1, fig. 20]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_islands
