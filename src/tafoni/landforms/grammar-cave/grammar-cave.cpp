// Caves of a shape grammar with morphing. cave_mouth.h finds where a cave opens, cave_body.h grows its air
// there, cave_floor.h a way to walk through it. The layer bends and wears the walls and takes the air out of
// the terrain, or makes a solid or a cast of it.

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/grammar/derive.h"
#include "tafoni/landforms/grammar-cave/cave_body.h"
#include "tafoni/landforms/grammar-cave/cave_floor.h"
#include "tafoni/landforms/grammar-cave/cave_mouth.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/measures.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms::landform_grammar_cave {
namespace {

using grammar::Pose;
using impl::CaveMouth;
using impl::Ground;
using impl::Stretch;

enum class Stream : std::uint64_t { bends = 1, floor = 3 };

// Chosen by eye.
constexpr double least_size = 2.5, most_size = 8, size_share = 20;  // metres; of the shorter side
constexpr double least_depth = 3, depth_in_sizes = 1.5;  // of sediment: deep enough for any hollow below it
constexpr double mouth_within = 6, mouth_within_sizes = 2;  // metres and sizes in which the ground shall rise
constexpr double less_rise = 0.6;  // share of the rise wanted, where no hillside has all of it
constexpr double mouth_floor = 1.3,
                 mouth_more = 0.5;  // passage mouths and metres of level floor to each side
constexpr double bend_lateral = 1.1, bend_vertical = 0.9, bend_up = 0.6;  // sizes; share
constexpr int bend_octaves = 4;
constexpr double bedding_most = 0.75;  // of the terrain's amplitude: beyond it walls would break open

constexpr float far = 1e6f;  // more rock than any terrain has
constexpr double steep = 4;  // how fast the walls' field becomes that much beyond the box

struct Params : impl::BodySettings {
  Params() {
    direction = "random";
    per_shape = 1;
    size = 0;
    flat = 0.7;
    overlap = 0.3;
    branches = 0.3;
    differences = 0.1;
  }
  std::string mode = "carve";
  std::int64_t detail = 10;
  double morph_percent = 52;                                                      ///< `morph` of the grammar
  std::string solid_names = "cube ellipsoid sphere cylinder cone pyramid torus";  ///< its `solids`
  std::vector<double> at;
  bool floor = true;
  double roughness = 0.12;
  double bedding = 0.08;
  double lip = 0.3;
  bool alone = false;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    const Values a_solid = {{"mode", std::string("solid")}};
    ParamTable<Params> t;
    t.choice("mode", &Params::mode, {"carve", "solid", "cast"},
             "What is made: a cave in the rock with an entrance (carve), a free solid (solid), or what carve "
             "would take out, in place of the terrain (cast)")
        .integer("detail", &Params::detail, "", 1, 32,
                 "Samples a size for `tafoni metrics --sgm` (L_D); a build goes by the scene's voxel")
        .only("for `tafoni metrics --sgm`; it changes no shape")
        .integer("classic", &Params::classic, "", 1, 1000,
                 "Sums, differences and intersections (P_C); more makes a longer cave")
        .integer("morphic", &Params::morphic, "", 0, 1000, "Morphs (P_M), 0 for pure solids")
        .choice("label", &Params::direction, grammar::direction_names(),
                "Side of the cave on which shapes are added (L_B); +X leads into the hill")
        .real("morph", &Params::morph_percent, "%", 0, 100,
              "Share of the added shape in a morph (M_P): 0 leaves the cave's own, 100 puts the shape in its "
              "place")
        .integer("per_shape", &Params::per_shape, "", 0, 10,
                 "Solids that make up one shape (P_S); 0 and 1 for bare solids")
        .text("solids", &Params::solid_names, "Names of the solids to draw from; see `tafoni list solids`")
        .real("size", &Params::size, "m", 0, 1000,
              "Half the width of a middling shape, 0 for a twentieth of the terrain's shorter side but 2.5 m "
              "to 8 m")
        .numbers("spread", &Params::spread, "", 2, 0.05, 20,
                 "Least and greatest half width, as multiples of the size")
        .real("flat", &Params::flat, "", 0.1, 5, "Heights as a share of widths")
        .real("overlap", &Params::overlap, "", 0, 1,
              "Share of its extent by which a shape is pushed into the cave, 0 for shapes that just touch")
        .real("branches", &Params::branches, "", 0, 1,
              "Share of productions that do not continue the last shape, 0 for one long line")
        .real("differences", &Params::differences, "", 0, 1,
              "Share of classic productions that put rock back")
        .real("intersections", &Params::intersections, "", 0, 1,
              "Share of classic productions that cut a shape down to another")
        .boolean("turn", &Params::turn, "Whether shapes may be turned to fit")
        .boolean("whole", &Params::whole,
                 "Whether morphs and intersections act on the whole cave, not on the part they touch")
        .rows("rule", &Params::rule, grammar::rule_columns(),
              "The grammar; without rules, shapes and places are drawn at random")
        .numbers("at", &Params::at, "m", 0, -1e9, 1e9,
                 "Of a cave, x and y of the entrance and, if wanted, the bearing inward in degrees from "
                 "north; of a solid, x, y and z of its middle; empty for a good place")
        .real("passage", &Params::passage, "m", 1.5, 50, "Radius of the entrance passage")
        .real("roof", &Params::roof, "m", 0, 1000, "Least rock over a cave")
        .real("storeys", &Params::storeys, "", 0, 100,
              "Most that the middle of a shape lies above or below the entrance, as a multiple of the size; "
              "0 keeps a cave level")
        .boolean("floor", &Params::floor, "Whether sediment makes a floor that can be walked")
        .real("roughness", &Params::roughness, "", 0, 1,
              "How far walls are bent at random, as a share of the size, 0 for the pure shapes")
        .real("bedding", &Params::bedding, "", 0, 1,
              "How far soft rock recedes, as a share of the size, 0 for not at all")
        .real("lip", &Params::lip, "", 0, 1,
              "How far the edge of the entrance is worn off, as a share of the size, 0 for a sharp one")
        .boolean("alone", &Params::alone, "Whether a solid stands in place of the terrain")
        .only("where mode is solid", a_solid);
    return t;
  }();
  return params;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

class Cave {
 public:
  Cave(const Ground& ground, const Params& p, Progress& progress)
      : ground_(ground), site_(ground.site()), p_(p), progress_(progress) {
    const Vec3d extent = ground.box().size();
    if (!(p_.size > 0))
      p_.size = std::clamp(std::min(extent.x, extent.y) / size_share, least_size, most_size);
    p_.morph = p.morph_percent / 100;
    p_.solids = words(p.solid_names);
    p_.seed = site_.seed;
    way_settings_.seed = hash_combine(site_.seed, Stream::floor);
    way_settings_.depth = std::max(least_depth, depth_in_sizes * p_.size);
  }

  Result carve() {
    const auto mouth = this->mouth();
    if (!mouth && !p_.rule.empty()) {
      grammar::Assembly trial;  // says what is wrong with the rules, wherever a cave may be
      impl::derive(trial, p_, nullptr, progress_);
    }
    if (!mouth)
      return nothing(p_.at.empty()
                         ? "no hillside rises high enough over level ground; give its entrance as at"
                         : "its entrance lies outside the terrain or where the layer may not act");
    frame_ = {mouth->inward, cross(Vec3d{0, 0, 1}, mouth->inward), {0, 0, 1}, mouth->at};
    const impl::CaveBody body = impl::dig_body(ground_, frame_, way_settings_.lift, p_, progress_);
    shape_ = body.shape;
    if (shape_.classic() + shape_.morphic() == 0)
      return nothing("there is no room in the rock behind the entrance; give another or a smaller size");
    if (p_.floor)
      way_ = impl::find_way(ground_, shape_.parts(), frame_, body.passage_length,
                            mouth_floor * impl::flare * p_.passage + mouth_more, way_settings_);
    Box3d box = frame_.placed(shape_.bounds()).grown(bend() + wear());
    for (const Stretch& s : way_.stretches) {
      Box3d reached;
      reached.expand(s.from);
      reached.expand(s.to + Vec3d{0, 0, 2 * way_settings_.lift});
      box.expand(reached.grown(way_settings_.radius));
    }
    Result result;
    result.facts = facts_of(measures(box));
    result.facts.places("entrances", {mouth->at})
        .about("x, y and z of the way in, on its floor")
        .places("route", way_.route)
        .about("x, y and z of places on the floor, from outside to the far end");
    const bool cast = p_.mode == "cast";
    result.reshape = [cast, rock = walls(box), floor = floors(), lip = lip()](const field::NodePtr& tree) {
      field::NodePtr carved = lip > 0 ? field::round_edge(tree, rock, lip) : field::intersect({tree, rock});
      if (floor) carved = field::unite({carved, field::intersect({tree, floor})});
      return cast ? field::subtract(tree, carved) : carved;
    };
    result.reshaped = cast ? Box3d::everything() : around(box);
    result.lowest = around(box).lo.z;
    return result;
  }

  Result solid() {
    impl::derive(shape_, p_, nullptr, progress_);
    const Box3d own = shape_.bounds();
    const Box3d& land = ground_.box();
    Vec3d middle = land.center();
    middle.z = land.hi.z + own.size().z;
    if (!p_.at.empty()) middle = Vec3d{p_.at[0], p_.at[1], p_.at[2]} - site_.origin;
    if (!ground_.usable(middle)) return nothing("the solid would stand where the layer may not act");
    frame_.at = middle - own.center();
    const Box3d box = frame_.placed(own).grown(bend() + wear());
    Result result;
    result.facts = facts_of(measures(box));
    // Walls are rock around air: the solid is the other side of them.
    result.reshape = [rock = walls(box), alone = p_.alone](field::NodePtr tree) {
      const field::NodePtr inside = field::subtract(field::constant(far), rock);
      return alone ? inside : field::unite({std::move(tree), inside});
    };
    result.reshaped = p_.alone ? Box3d::everything() : around(box);
    result.lowest = around(box).lo.z;
    return result;
  }

 private:
  double bend() const { return p_.roughness * p_.size; }
  double lip() const { return p_.lip * p_.size; }
  double wear() const { return std::min(p_.bedding * p_.size, bedding_most * site_.amplitude); }
  /// Beyond it a box's walls are more rock than any terrain has. They become so at a distance, or faces of
  /// the solid that touch the box would lie between values of unlike slopes.
  Box3d around(const Box3d& box) const { return box.grown(p_.size + site_.amplitude + lip()); }

  Result nothing(std::string_view why) {
    progress_.warn(fmt::format("grammar-cave makes nothing: {}", why));
    Result result;
    result.facts.count("productions", 0)
        .about("Rules of the grammar that were applied, classic and morphic")
        .count("primitives", 0);
    return result;
  }

  std::optional<CaveMouth> mouth() {
    impl::MouthSettings settings;
    settings.rise = way_settings_.lift + p_.flat * p_.size + p_.roof;
    settings.within = mouth_within + mouth_within_sizes * p_.size;
    if (!p_.at.empty()) {
      const Vec2d at{p_.at[0] - site_.origin.x, p_.at[1] - site_.origin.y};
      CaveMouth given = impl::mouth_at(ground_, at, settings);
      if (p_.at.size() == 3) given.inward = {std::sin(p_.at[2] * degree), std::cos(p_.at[2] * degree), 0};
      return ground_.usable(given.at) ? std::optional(given) : std::nullopt;
    }
    for (const double share : {1.0, less_rise}) {
      impl::MouthSettings less = settings;
      less.rise *= share;
      if (auto found = impl::find_mouth(ground_, less, progress_)) return found;
    }
    return std::nullopt;
  }

  /// The field of the rock around the cave, as if all else were rock.
  field::NodePtr walls(const Box3d& box) const {
    field::NodePtr air = grammar::tree(placed(shape_.form(), frame_));
    if (bend() > 0) {
      field::WarpSettings warp;
      warp.amplitude = Vec3d{1, 1, bend_up} * bend();
      warp.lateral = bend_lateral * p_.size;
      warp.vertical = bend_vertical * p_.size;
      warp.octaves = bend_octaves;
      warp.seed = hash_combine(site_.seed, Stream::bends);
      air = field::warp(std::move(air), nullptr, warp);
    }
    field::NodePtr rock = field::subtract(field::constant(far), std::move(air));
    if (site_.geology && wear() > 0)
      rock = field::erode(std::move(rock), nullptr, geology::as_function(site_.geology), wear());
    if (!way_.stretches.empty())
      rock = field::subtract(std::move(rock), field::function(room_of(way_.stretches, way_settings_)));
    // So that nothing changes far beyond the box, whatever warps and geology say there.
    return field::unite({std::move(rock), field::function(impl::outside_of(box.grown(p_.size), steep))});
  }

  /// The sediment in it; null for none.
  field::NodePtr floors() const {
    return way_.stretches.empty() ? nullptr : field::function(floor_of(way_.stretches, way_settings_));
  }

  GrammarCaveMeasures measures(const Box3d& box) const {
    return {.classic = shape_.classic(),
            .morphic = shape_.morphic(),
            .elements = static_cast<std::int64_t>(shape_.elements()),
            .size = p_.size,
            .detail = p_.detail,
            .box = box};
  }

  const Ground& ground_;
  const Site& site_;
  Params p_;  ///< with the grammar's own settings filled in
  Progress& progress_;
  impl::WaySettings way_settings_;
  Pose frame_;
  grammar::Assembly shape_;
  impl::Way way_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "grammar-cave");
  if (p.spread[0] > p.spread[1])
    fail(ErrorKind::usage, "grammar-cave: spread must not begin with the greater number");
  for (const std::string& name : words(p.solid_names)) grammar::find_solid(name);
  if (p.rule.empty() && words(p.solid_names).empty())
    fail(ErrorKind::usage, "grammar-cave: solids names none; see `tafoni list solids`");
  if (p.size > 0 && p.size < 0.05)
    fail(ErrorKind::usage, "grammar-cave: size = {:g} is outside 0.05 to 1000 m; 0 lets the layer choose",
         p.size);
  const bool solid = p.mode == "solid";
  if (!p.at.empty() && p.at.size() != 3 && (solid || p.at.size() != 2))
    fail(ErrorKind::usage, "grammar-cave: at must hold {}",
         solid ? "x, y and z" : "x and y, and a bearing if wanted");
  const Ground ground(site);
  progress.check();
  Cave cave(ground, p, progress);
  return solid ? cave.solid() : cave.carve();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "grammar-cave",
                .doc =
                    "Caves of a shape grammar with morphing: solids joined, cut and morphed by productions",
                .source = "[Zawadzki]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_grammar_cave
