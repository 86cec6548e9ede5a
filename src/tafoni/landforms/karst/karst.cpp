// Caves that water opens through rock. Water enters where entrances.cpp says, percolation.cpp leads it down
// through the softest rock, passages.cpp makes passages and rooms of its ways, and carving.cpp carves them
// (declared in passages.h). Here are the parameters of all four and how the steps follow each other.

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/landforms/karst/entrances.h"
#include "tafoni/landforms/karst/passages.h"
#include "tafoni/landforms/karst/percolation.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::landform_karst {
namespace {

using impl::Ground;

enum class Stream : std::uint64_t { passages = 0x5e };

struct Params : impl::CaveSize, impl::EntranceSettings, impl::PercolationSettings, impl::PassageSettings {
  double passage = 500;        ///< metres for each seed
  double base_level = -12000;  ///< world elevation
  double cover = 1.2;          ///< radii of rock over a passage
};

// Chosen by eye.
constexpr double least_radius = 2.5;      // metres: a passage that a person can walk
constexpr double spacing_in_radii = 5;    // passages that are this far apart leave sound rock between them
constexpr double descent_in_radii = 5;    // an entrance needs so much height above the lowest level of caves
constexpr double bottom_in_radii = 1.2;   // passages keep so far above the terrain's lowest ground
constexpr double tube_in_radii = 1.6;     // a tube's own radius above its axis, its unevenness and winding
constexpr double exit_share = 0.8;        // of face_slope: ways come out on ground a little less steep too
constexpr double link_in_spacings = 1.2;  // mean length of a way from point to point

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("radius", &Params::radius, "m", 0, 200,
           "Half the width of a middling passage, 0 for half a pixel of the terrain but 2.5 m at least")
        .real("spacing", &Params::spacing, "m", 0, 2000,
              "Radius of the Poisson spheres that keep passages apart, 0 for five times the radius; more "
              "makes fewer and straighter ways")
        .integer("sinks", &Params::sinks, "", 0, 10000,
                 "Most entrances in closed depressions or, where there are too few, in the softest gentle "
                 "ground")
        .integer("faces", &Params::faces, "", 0, 10000, "Most entrances in cliff faces")
        .only("where the sinks leave room for more", {{"sinks", std::int64_t{0}}})
        .real("sink_depth", &Params::sink_depth, "m", 0, 1000,
              "Depressions shallower than this swallow no water")
        .only("where the terrain has closed depressions")
        .real("face_slope", &Params::face_slope, "deg", 5, 89,
              "Slope from which ground counts as a cliff face")
        .only("where the sinks leave room for more", {{"sinks", std::int64_t{0}}})
        .real("passage", &Params::passage, "m", 10, 1e6,
              "About the length of passage that one entrance may grow")
        .real("depth", &Params::depth, "m", 1, 5000, "How far caves go down below their entrance")
        .real("base_level", &Params::base_level, "m", -12000, 10000,
              "Elevation below which there are no caves")
        .real("resistance", &Params::resistance, "", 0, 1,
              "Rock as hard as this or harder is not carved (rho_0); 1 lets caves cross any rock")
        .real("epsilon", &Params::epsilon, "", 0, 1,
              "Share of chance in what rock gives way next, 0 for the softest always")
        .integer("directions", &Params::directions, "", 1, 64,
                 "Ways on that are tried around a carved point; more makes denser networks")
        .real("steepness", &Params::steepness, "", 0, 1,
              "How steeply water seeks its way: 0 for level, 1 for all directions of the lower hemisphere "
              "alike")
        .real("cover", &Params::cover, "", 0, 20, "Rock left over passages, as a multiple of their radius")
        .real("beta", &Params::beta, "", 0, 1,
              "Effect of full stress on the most resistant rock; 1 makes passages as wide in hard rock as in "
              "soft")
        .real("threshold", &Params::threshold, "", 0, 1,
              "Dead ends with a smaller erosion effect than this are left out; 0 keeps them all")
        .real("roughness", &Params::roughness, "", 0, 1, "Unevenness of the walls, 0 for smooth tubes")
        .real("winding", &Params::winding, "", 0, 1,
              "How far passages wind off the straight line, 0 for not at all")
        .real("chambers", &Params::chambers, "", 0, 1,
              "How often rooms break out where ways meet or the rock is weak, 0 for none")
        .numbers("springs", &Params::springs, "m", 0, -1e8, 1e8,
                 "Places where the water shall come to light again, x, y and z of each");
    return t;
  }();
  return params;
}

/// The sizes as given, or such as fit the terrain.
impl::CaveSize size_on(const Ground& ground, const impl::CaveSize& given) {
  impl::CaveSize size = given;
  if (!(size.radius > 0)) size.radius = std::max(least_radius, 0.5 * ground.pixel());
  if (!(size.spacing > 0)) size.spacing = spacing_in_radii * size.radius;
  return size;
}

Facts facts_of(const Ground& ground, const impl::CaveSystem& caves, const field::NodePtr& node,
               const std::vector<bool>& open) {
  double deepest = 0;
  for (const impl::Passage& passage : caves.passages)
    for (Vec3d p : passage.line) deepest = std::max(deepest, ground.height(p.x, p.y) - p.z);
  Facts facts;
  facts.count("entrances", std::ssize(caves.entrances))
      .about("Ways into the caves from the surface: sinks, mouths in faces, exits and springs")
      .places("entrance_positions", caves.entrances)
      .about("x, y and z of each entrance in turn")
      .count("chambers", std::ssize(caves.chambers))
      .about("Places where a passage widens to a room")
      .length("passage_length", caves.length)
      .about("Length of the middle lines of all passages")
      .count("networks", caves.networks)
      .about("Groups of passages that lead into one another")
      .count("connected_networks", std::count(open.begin(), open.end(), true))
      .about("Networks whose passages are all open along their middle lines; in the others rock closes one")
      .count("primitives", node ? field::stats(node).primitives : 0)
      .length("greatest_depth", deepest)
      .about("Greatest vertical distance from the ground down to the middle line of a passage");
  return facts;
}

Result make(const Site& site, const Params& p, Progress& progress) {
  const Ground ground(site);
  Result result;
  result.facts = facts_of(ground, {}, nullptr, {});
  if (ground.box().empty()) return result;

  const field::CompiledField rock = field::compile(site.terrain);
  const impl::CaveSize size = size_on(ground, p);
  const auto& heights = site.heights->values.values();
  const double lowest = *std::min_element(heights.begin(), heights.end());
  const double base = p.base_level - site.origin.z;

  const impl::Entrances entrances = impl::choose_entrances(
      rock, ground, size, std::max(lowest, base) + descent_in_radii * size.radius, p, progress);

  impl::PercolationSpace space;
  space.spacing = size.spacing;
  space.cover = (p.cover + tube_in_radii) * size.radius;
  space.base_z = std::max(base, lowest + bottom_in_radii * size.radius);
  space.face_z = std::cos(exit_share * p.face_slope * degree);
  const double points = std::max(2.0, p.passage / (link_in_spacings * size.spacing));
  space.points_per_seed = floor_to<std::size_t>(points);
  space.seed = site.seed;
  const impl::Percolation ways = impl::percolate(rock, ground, entrances, p, space, progress);

  const std::uint64_t seed = hash_combine(site.seed, Stream::passages);
  const impl::CaveSystem caves = impl::make_passages(rock, ground, ways, size, p, seed);
  const field::NodePtr node = impl::carve_passages(caves, ground, size, p, seed);
  if (!node) return result;

  const auto carved = field::compile(field::blend({site.terrain, node}));
  result.facts = facts_of(ground, caves, node, impl::open_networks(carved, caves));
  result.nodes.push_back(node);
  return result;
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "karst");
  return make(site, p, progress);
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "karst",
                .doc = "Caves that water opens through soft rock, with sinkholes above and exits in cliffs",
                .source = "[Paris19 §6.2]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_karst
