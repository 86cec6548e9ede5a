#include <algorithm>
#include <cmath>
#include <sstream>

#include "tafoni/core/error.h"
#include "tafoni/grammar/derive.h"
#include "tafoni/landforms/grammar-cave/cave_mouth.h"
#include "tafoni/landforms/grammar-cave/cave_way.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms {
namespace {

using grammar::Assembly;
using grammar::Part;
using grammar::Pose;
using impl::Ground;
using impl::Mouth;
using impl::Stretch;

struct Params {
  std::string mode = "carve";
  std::int64_t detail = 10;
  std::int64_t classic = 10;
  std::int64_t morphic = 2;
  std::string label = "random";
  double morph = 52;
  std::int64_t per_shape = 1;
  std::string solids = "cube ellipsoid sphere cylinder cone pyramid torus";
  double size = 0;
  std::vector<double> spread = {0.6, 1.4};
  double flat = 0.7;
  double overlap = 0.3;
  double branches = 0.3;
  double differences = 0.1;
  double intersections = 0;
  bool turn = true;
  bool whole = false;
  Rows rule;
  std::vector<double> at;
  double passage = 1.8;
  double roof = 2.5;
  double storeys = 0.5;
  bool floor = true;
  double roughness = 0.12;
  double bedding = 0.08;
  double lip = 0.3;
  bool alone = false;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.choice(
         "mode", &Params::mode, {"carve", "solid", "cast"},
         "carve: a cave in the rock with an entrance; solid: a free solid; cast: what carve would take out, "
         "in place of the terrain")
        .integer("detail", &Params::detail, "", 1, 32,
                 "L_D: samples a size for `tafoni metrics --sgm`; a build goes by the scene's voxel")
        .integer("classic", &Params::classic, "", 1, 1000, "P_C: sums, differences and intersections")
        .integer("morphic", &Params::morphic, "", 0, 1000, "P_M: morphs")
        .choice("label", &Params::label, grammar::direction_names(),
                "L_B: side of the cave on which shapes are added; +X leads into the hill")
        .real("morph", &Params::morph, "%", 0, 100, "M_P: share of the added shape in a morph")
        .integer("per_shape", &Params::per_shape, "", 0, 10, "P_S: solids that make up one shape")
        .text("solids", &Params::solids, "names of the solids to draw from; see `tafoni list solids`")
        .real("size", &Params::size, "m", 0, 1000,
              "half the width of a middling shape, 0 for a twentieth of the terrain's shorter side but 2.5 m "
              "to 8 m")
        .numbers("spread", &Params::spread, "", 2, 0.05, 20,
                 "least and greatest half width, as multiples of the size")
        .real("flat", &Params::flat, "", 0.1, 5, "heights as a share of widths")
        .real("overlap", &Params::overlap, "", 0, 1,
              "share of its extent by which a shape is pushed into the cave; 0 for shapes that just touch")
        .real("branches", &Params::branches, "", 0, 1,
              "share of productions that do not continue the last shape")
        .real("differences", &Params::differences, "", 0, 1,
              "share of classic productions that put rock back")
        .real("intersections", &Params::intersections, "", 0, 1,
              "share of classic productions that cut a shape down to another")
        .boolean("turn", &Params::turn, "whether shapes may be turned to fit")
        .boolean("whole", &Params::whole,
                 "whether morphs and intersections act on the whole cave, not on the part they touch")
        .rows("rule", &Params::rule, grammar::rule_columns(),
              "the grammar; without rules, shapes and places are drawn at random")
        .numbers("at", &Params::at, "m", 0, -1e9, 1e9,
                 "of a cave: x and y of the entrance and, if wanted, the bearing inward in degrees from "
                 "north; of a "
                 "solid: x, y and z of its middle; empty for a good place")
        .real("passage", &Params::passage, "m", 1.5, 50, "radius of the entrance passage")
        .real("roof", &Params::roof, "m", 0, 1000, "least rock over a cave")
        .real("storeys", &Params::storeys, "", 0, 100,
              "most that the middle of a shape lies above or below the entrance, as a multiple of the size")
        .boolean("floor", &Params::floor, "whether sediment makes a floor that can be walked")
        .real("roughness", &Params::roughness, "", 0, 1,
              "how far walls are bent at random, as a share of the size; 0 for the pure shapes")
        .real("bedding", &Params::bedding, "", 0, 1,
              "how far soft rock recedes, as a share of the size; 0 for not at all")
        .real("lip", &Params::lip, "", 0, 1,
              "how far the edge of the entrance is worn off, as a share of the size; 0 for a sharp one")
        .boolean("alone", &Params::alone, "whether a solid stands in place of the terrain");
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

grammar::Settings settings_of(const Params& p, double size, std::uint64_t seed) {
  grammar::Settings s;
  s.classic = static_cast<int>(p.classic);
  s.morphic = static_cast<int>(p.morphic);
  s.direction = p.label;
  s.morph = p.morph / 100;
  s.per_shape = static_cast<int>(p.per_shape);
  s.solids = words(p.solids);
  s.size = size;
  s.spread = p.spread;
  s.flat = p.flat;
  s.overlap = p.overlap;
  s.branches = p.branches;
  s.differences = p.differences;
  s.intersections = p.intersections;
  s.turn = p.turn;
  s.whole = p.whole;
  s.seed = seed;
  return s;
}

/// Within the rock, `roof` metres below the ground, where the layer may act, and level with the mouth but for
/// `climb` metres.
class Room {
 public:
  Room(const Ground& ground, const Pose& frame, double roof, double climb)
      : ground_(ground),
        rock_(field::compile(ground.site().terrain)),
        frame_(frame),
        roof_(roof),
        climb_(climb) {}

  bool operator()(const Box3d& box) const {
    if (std::abs(box.center().z) > climb_) return false;
    const Vec3d size = box.size();
    std::vector<Vec3d> points;
    const auto layer = [&](double z, int i_most, int j_most) {
      for (int i = 0; i <= i_most; ++i)
        for (int j = 0; j <= j_most; ++j)
          points.push_back(
              frame_.placed(Vec3d{box.lo.x + size.x * i / i_most, box.lo.y + size.y * j / j_most, z}));
    };
    const auto metres = [](double way) { return std::clamp(static_cast<int>(std::ceil(way)), 1, 64); };
    layer(box.hi.z + roof_, metres(size.x), metres(size.y));
    layer(box.center().z, 4, 4);
    layer(box.lo.z, 4, 4);
    if (!std::all_of(points.begin(), points.end(), [&](Vec3d p) { return ground_.usable(p, 1); }))
      return false;
    std::vector<float> values(points.size());
    rock_.values(points, values);
    return std::all_of(values.begin(), values.end(), [](float v) { return v > 0; });
  }

 private:
  const Ground& ground_;
  field::CompiledField rock_;
  Pose frame_;
  double roof_, climb_;
};

/// The way in: from before the mouth through every part that can be reached on foot.
struct Way {
  std::vector<Stretch> stretches;
  std::vector<Vec3d> route;  ///< to the part that is farthest
};

class Cave {
 public:
  Cave(const Ground& ground, const Params& p, Progress& progress)
      : ground_(ground), site_(ground.site()), p_(p), progress_(progress) {
    const Vec3d extent = ground.box().size();
    size_ = p.size > 0 ? p.size : std::clamp(std::min(extent.x, extent.y) / 20, 2.5, 8.0);
    way_.seed = hash_combine(site_.seed, 3);
    way_.depth = std::max(3.0, 1.5 * size_);
  }

  Result carve() {
    const auto mouth = this->mouth();
    if (!mouth)
      return nothing(p_.at.empty()
                         ? "no hillside rises high enough over level ground; give its entrance as at"
                         : "its entrance lies outside the terrain or where the layer may not act");
    frame_ = {mouth->inward, cross(Vec3d{0, 0, 1}, mouth->inward), {0, 0, 1}, mouth->at};
    if (!dig())
      return nothing("there is no room in the rock behind the entrance; give another or a smaller size");
    if (p_.floor) find_way();
    Box3d box = frame_.placed(base_.bounds()).grown(bend() + wear());
    for (const Stretch& s : found_.stretches) {
      Box3d reached;
      reached.expand(s.from);
      reached.expand(s.to + Vec3d{0, 0, 2 * way_.lift});
      box.expand(reached.grown(way_.radius));
    }
    Result result = report(box);
    result.report.emplace_back("entrances", world({mouth->at}));
    result.report.emplace_back("route", world(found_.route));
    const bool cast = p_.mode == "cast";
    result.reshape = [cast, rock = walls(box), floor = floors(), lip = lip()](const field::NodePtr& tree) {
      field::NodePtr carved = lip > 0 ? field::round_edge(tree, rock, lip) : field::intersect({tree, rock});
      if (floor) carved = field::unite({carved, field::intersect({tree, floor})});
      return cast ? field::subtract(tree, carved) : carved;
    };
    result.reshaped = cast ? Box3d::everything() : around(box);
    return result;
  }

  Result solid() {
    derive(nullptr);
    const Box3d own = base_.bounds();
    const Box3d& land = ground_.box();
    Vec3d middle = land.center();
    middle.z = land.hi.z + own.size().z;
    if (!p_.at.empty()) middle = Vec3d{p_.at[0], p_.at[1], p_.at[2]} - site_.origin;
    if (!ground_.usable(middle)) return nothing("the solid would stand where the layer may not act");
    frame_.at = middle - own.center();
    const Box3d box = frame_.placed(own).grown(bend() + wear());
    Result result = report(box);
    // Walls are rock around air: the solid is the other side of them.
    result.reshape = [rock = walls(box), alone = p_.alone](field::NodePtr tree) {
      const field::NodePtr inside = field::subtract(field::constant(far), rock);
      return alone ? inside : field::unite({std::move(tree), inside});
    };
    result.reshaped = p_.alone ? Box3d::everything() : around(box);
    return result;
  }

 private:
  static constexpr float far = 1e6f;
  static constexpr double steep = 4;

  double bend() const { return p_.roughness * size_; }
  /// Beyond it a box's walls are more rock than any terrain has. They become so at a distance, or faces of
  /// the solid that touch the box would lie between values of unlike slopes.
  Box3d around(const Box3d& box) const { return box.grown(size_ + site_.amplitude + lip()); }
  double lip() const { return p_.lip * size_; }
  double wear() const { return std::min(p_.bedding * size_, 0.75 * site_.amplitude); }

  Result nothing(std::string_view why) {
    progress_.warn(fmt::format("grammar-cave makes nothing: {}", why));
    Result result;
    result.report = {{"productions", std::int64_t{0}}, {"primitives", std::int64_t{0}}};
    return result;
  }

  std::optional<Mouth> mouth() {
    impl::MouthSettings settings;
    settings.rise = way_.lift + p_.flat * size_ + p_.roof;
    settings.within = 6 + 2 * size_;
    if (!p_.at.empty()) {
      const Vec2d at{p_.at[0] - site_.origin.x, p_.at[1] - site_.origin.y};
      Mouth given = impl::mouth_at(ground_, at, settings);
      constexpr double degree = 0.017453292519943295;
      if (p_.at.size() == 3) given.inward = {std::sin(p_.at[2] * degree), std::cos(p_.at[2] * degree), 0};
      return ground_.usable(given.at) ? std::optional(given) : std::nullopt;
    }
    for (const double share : {1.0, 0.6}) {
      impl::MouthSettings less = settings;
      less.rise *= share;
      if (auto found = impl::find_mouth(ground_, less, progress_)) return found;
    }
    return std::nullopt;
  }

  void derive(const Assembly::Accept& accept) {
    const grammar::Settings settings = settings_of(p_, size_, site_.seed);
    if (p_.rule.empty())
      derive_at_random(base_, settings, accept, progress_);
    else
      derive_by_rules(base_, p_.rule, settings, accept, progress_);
  }

  /// A cone that opens outward, on which the grammar goes on at its inner end.
  void begin(double length) {
    constexpr double before = 1;
    const double wide = flare * p_.passage;
    const auto& cone = grammar::find_solid("cone");
    grammar::Shape shape =
        shape_of(cone.make({{"base", wide}, {"tip", p_.passage}, {"height", length + before}}));
    Pose pose = grammar::turn({0, 0, 1}, {1, 0, 0});
    pose.at = {(length - before) / 2, 0, way_.lift};
    std::erase_if(shape.bonds, [](const grammar::Bond& bond) { return bond.direction.z < 0.99; });
    shape.form = placed(shape.form, pose);
    shape.bounds = pose.placed(shape.bounds);
    for (grammar::Bond& bond : shape.bonds) bond = pose.placed(bond);
    // Weather has widened it into a niche.
    const auto& ellipsoid = grammar::find_solid("ellipsoid");
    grammar::Shape niche = shape_of(ellipsoid.make(ellipsoid.fit({0.5 * length, 1.3 * wide, wide})));
    Pose at;
    at.at = {0.5 * length - before, 0, 0.6 * way_.lift};
    shape.form = grammar::combined(grammar::Operation::sum, shape.form, placed(niche.form, at));
    shape.bounds.expand(at.placed(niche.bounds));
    shape.elements += niche.elements;
    base_ = {};
    base_.begin(shape);
  }

  /// As short a passage as lets the grammar grow, but no shorter.
  bool dig() {
    const Room room(ground_, frame_, p_.roof, way_.lift + p_.storeys * size_);
    Assembly best;
    const auto count = [](const Assembly& a) { return a.classic() + a.morphic(); };
    for (const double length : {5.0, 8.0, 12.0, 17.0, 24.0, 34.0}) {
      begin(length);
      derive(room);
      if (count(base_) > count(best)) best = base_, passage_length_ = length;
      if (count(best) > 0.8 * static_cast<double>(p_.classic + p_.morphic)) break;
    }
    base_ = std::move(best);
    return count(base_) > 0;
  }

  /// A part's place on the way.
  struct Node {
    bool reached = false;
    Vec3d at, door;
    double length = 0;
    int parent = -1;
  };

  /// As steep as it takes to the part's own floor, or less steep where that would cross another stretch.
  Node reach(const Part& part, const Node& from) {
    constexpr double headroom = 2.2;
    const auto plan = [](Vec3d a, Vec3d b) { return std::hypot(a.x - b.x, a.y - b.y); };
    Vec3d to = part.core.center(), door = part.door.point;
    const double before = plan(from.at, door), length = before + plan(door, to);
    if (!from.reached || length < 0.1) return {};
    const double floor = part.core.lo.z + 0.3 * part.core.size().z;
    for (const double steepest : {0.4, 0.2, 0.0}) {
      to.z = std::clamp(floor, from.at.z - steepest * length, from.at.z + steepest * length);
      if (to.z < part.core.lo.z - 0.5 || to.z > part.core.hi.z - headroom) return {};
      door.z = from.at.z + (to.z - from.at.z) * before / length;
      const Stretch first{frame_.placed(from.at), frame_.placed(door)},
          second{frame_.placed(door), frame_.placed(to)};
      if (crosses(first) || crosses(second)) continue;
      found_.stretches.push_back(first);
      found_.stretches.push_back(second);
      return {true, to, door, from.length + length, part.parent};
    }
    return {};
  }

  /// Whether the floor of one stretch would lie in the way of another.
  bool crosses(const Stretch& added) const {
    constexpr double step = 0.25, head = 2.4;
    const auto blocks = [&](const Stretch& s, const Stretch& other) {
      const int n = 2 + static_cast<int>(2 * length(s.to - s.from));
      for (int i = 0; i <= n; ++i) {
        const Vec3d p = s.from + (s.to - s.from) * (static_cast<double>(i) / n);
        const auto [top, on] = impl::floor_at(other, p);
        if (top > p.z + step && on - way_.depth < p.z + head) return true;
      }
      return false;
    };
    return std::any_of(found_.stretches.begin(), found_.stretches.end(),
                       [&](const Stretch& s) { return blocks(s, added) || blocks(added, s); });
  }

  /// Floors are joined from part to part wherever a slope that can be walked leads there.
  void find_way() {
    const auto& parts = base_.parts();
    std::vector<Node> nodes(parts.size());
    nodes[0] = {true, {passage_length_, 0, 0}, {}, passage_length_, -1};
    Vec3d outside = frame_.placed(Vec3d{-apron, 0, 0});
    outside.z = ground_.height(outside.x, outside.y);
    const Vec3d mouth = frame_.at, inner = frame_.placed(nodes[0].at);
    const double wide = 1.3 * flare * p_.passage + 0.5;
    found_.stretches.push_back({outside, mouth, wide, hinders(outside, mouth)});
    found_.stretches.push_back({mouth, inner, wide});
    std::size_t last = 0;
    for (std::size_t i = 1; i < parts.size(); ++i) {
      nodes[i] = reach(parts[i], nodes[static_cast<std::size_t>(parts[i].parent)]);
      if (nodes[i].length > nodes[last].length) last = i;
    }
    std::vector<Vec3d> back;
    for (auto i = static_cast<int>(last); i > 0; i = nodes[static_cast<std::size_t>(i)].parent) {
      back.push_back(frame_.placed(nodes[static_cast<std::size_t>(i)].at));
      back.push_back(frame_.placed(nodes[static_cast<std::size_t>(i)].door));
    }
    found_.route = {outside, mouth, inner};
    found_.route.insert(found_.route.end(), back.rbegin(), back.rend());
  }

  /// Whether the ground lies higher than a step above a way in the open.
  bool hinders(Vec3d from, Vec3d to) const {
    constexpr double step = 0.4;
    for (double t = 0; t <= 1; t += 0.1) {
      const Vec3d p = from + (to - from) * t;
      if (ground_.height(p.x, p.y) > p.z + step) return true;
    }
    return false;
  }

  /// The field of the rock around the cave, as if all else were rock.
  field::NodePtr walls(const Box3d& box) const {
    field::NodePtr air = grammar::tree(placed(base_.form(), frame_));
    if (bend() > 0) {
      field::WarpSettings warp;
      warp.amplitude = Vec3d{1, 1, 0.6} * bend();
      warp.lateral = 1.1 * size_;
      warp.vertical = 0.9 * size_;
      warp.octaves = 4;
      warp.seed = hash_combine(site_.seed, 1);
      air = field::warp(std::move(air), nullptr, warp);
    }
    field::NodePtr rock = field::subtract(field::constant(far), std::move(air));
    if (site_.geology && wear() > 0)
      rock = field::erode(std::move(rock), nullptr, geology::as_function(site_.geology), wear());
    if (!found_.stretches.empty())
      rock = field::subtract(std::move(rock), field::function(room_of(found_.stretches, way_)));
    // So that nothing changes far beyond the box, whatever warps and geology say there.
    return field::unite({std::move(rock), field::function(impl::outside_of(box.grown(size_), steep))});
  }

  /// The sediment in it; null for none.
  field::NodePtr floors() const {
    return found_.stretches.empty() ? nullptr : field::function(floor_of(found_.stretches, way_));
  }

  std::vector<double> world(const std::vector<Vec3d>& points) const {
    std::vector<double> out;
    for (const Vec3d p : points)
      out.insert(out.end(), {p.x + site_.origin.x, p.y + site_.origin.y, p.z + site_.origin.z});
    return out;
  }

  Result report(const Box3d& box) const {
    Result result;
    result.report = {{"productions", std::int64_t{base_.classic() + base_.morphic()}},
                     {"classic", std::int64_t{base_.classic()}},
                     {"morphic", std::int64_t{base_.morphic()}},
                     {"elements", static_cast<std::int64_t>(base_.elements())},
                     {"size_m", size_},
                     {"detail", p_.detail},
                     {"low", world({box.lo})},
                     {"high", world({box.hi})},
                     {"primitives", std::int64_t{0}}};
    return result;
  }

  static constexpr double apron = 6;    // metres walked before the mouth
  static constexpr double flare = 1.4;  // of the passage towards the mouth
  const Ground& ground_;
  const Site& site_;
  const Params& p_;
  Progress& progress_;
  double size_ = 1, passage_length_ = 0;
  impl::WaySettings way_;
  Pose frame_;
  Assembly base_;
  Way found_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "grammar-cave");
  if (p.spread[0] > p.spread[1])
    fail(ErrorKind::usage, "grammar-cave: spread must not begin with the greater number");
  for (const std::string& name : words(p.solids)) grammar::find_solid(name);
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

const LandformType& landform_grammar_cave() {
  static const LandformType type{
      .about = {.name = "grammar-cave",
                .doc =
                    "Caves of a shape grammar with morphing: solids joined, cut and morphed by productions",
                .source = "Zawadzki et al., Hybrid of Shape Grammar and Morphing [Zawadzki]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
