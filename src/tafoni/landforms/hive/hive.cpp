// A hive: rough ground by subdivision, chambers under it, tunnels from chamber to chamber and to mouths on
// hillsides, all joined and walkable [Ju01]. Rooms are placed first, then joined, then opened; what cannot be
// joined is not dug.

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "tafoni/core/random.h"
#include "tafoni/landforms/hive/hive_area.h"
#include "tafoni/landforms/hollows/hollow.h"
#include "tafoni/landforms/hollows/tunnel_planner.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/fractal_ground.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms::landform_hive {
namespace {

using impl::Ground;
using impl::TunnelPlanner;
using impl::WayEnd;

enum class Stream : std::uint64_t { rooms = 0x417e, ground = 1 };

/// Chosen by eye; lengths are in radii of the tunnels where nothing else is said.
namespace look {
// Rooms lie about the height of this share of the hillsides' mouths, from below: so ways are short and level.
constexpr int low_mouths = 2, of_mouths = 5;
// The shorter side of the area is so many rooms long at least; if there is no place for a room, it is tried
// smaller.
constexpr double rooms_across = 2.5, shrinks[] = {1.0, 0.75, 0.55};
// Samples of a cell of a room's lattice, at least.
constexpr double samples_a_cell = 4;
// Places tried for a room; the chance in a place's merit, and what a metre of height off the wanted floor
// takes from it.
constexpr int places = 500;
constexpr double chance = 6, height_loss = 0.7;
// Between rooms, for the tunnels to turn in; and metres of rock under a room.
constexpr double between_rooms = 6, under_room = 2;
// A door, in cells of the room: how far inside its outline and how high its floor lies. A way leads straight
// out of the room and so much farther.
constexpr double door_inset = 1.4, door_height = 0.55, door_straight = 2.5;
// Metres from step to step when the floor of a room is looked for.
constexpr double floor_step = 0.1;
// How many pairs of doors, and how many doors for a mouth, are tried, the nearest first.
constexpr std::ptrdiff_t door_pairs = 9, mouth_doors = 6;
// Mouths are first sought this share of the area apart, then nearer and nearer, down to so many radii.
constexpr double mouths_apart = 0.35, nearer = 0.6, least_apart = 4;
constexpr int mouth_tries = 600;
// A tunnel from a mouth where there is no room.
constexpr double lone_tunnel = 16;
// The rough ground: metres of its largest forms, or this share of the area; its samples.
constexpr double coarse = 40, coarse_share = 0.25, ground_spacing = 0.3;
}  // namespace look

struct Params : impl::HollowParams, impl::TunnelParams {
  double size = 220;
  double noise = 0.25;
  std::int64_t entrances = 3;
  std::int64_t chambers = 3;
  std::string kinds = "storage queen hall";
  double cell = 0;
  double chamber_noise = 0.04;
  double slope = 25;
  double depth = 0;
  Params() { cover = 4; }
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("size", &Params::size, "m", 10, 5000,
           "Side of the square of ground that it takes, about the layer's first point or where the ground is "
           "most uneven")
        .real("noise", &Params::noise, "", 0, 5,
              "Roughness of the ground over it, as fractal-terrain has it; 0 leaves the ground as it is")
        .integer("entrances", &Params::entrances, "", 0, 100, "Most entrances that are opened on hillsides")
        .integer("chambers", &Params::chambers, "", 0, 100, "Most chambers that are dug")
        .text("kinds", &Params::kinds, "Kinds of the chambers, in turn; see the landform chambers")
        .real("cell", &Params::cell, "m", 0, 100,
              "Side of a cell of the chambers' lattices; 0 for the kinds' own or what fits")
        .real("chamber_noise", &Params::chamber_noise, "", 0, 2, "Unevenness of chambers, in cells")
        .real("radius", &Params::radius, "m", 0.5, 100, "Radius of the tunnels, on average")
        .real(
            "wander", &Params::wander, "", 0, 0.5,
            "Most that the middle of a tunnel's stretch lies off its straight line, as a share of its length")
        .real("slope", &Params::slope, "deg", 1, 60, "Slope of the steepest floor of a tunnel")
        .real("cover", &Params::cover, "m", 0, 1000, "Least rock that is left over a roof")
        .real("depth", &Params::depth, "m", 0, 10000,
              "How far below the lowest ground may be dug; 0 for almost the terrain's influence");
    impl::add_hollow_params(t);
    return t;
  }();
  return params;
}

/// A chamber that the hive has, with its four doors.
struct Room {
  volume::Chamber chamber;
  std::vector<WayEnd> doors;
  Vec3d stand;  ///< on its floor
};

class Hive {
 public:
  Hive(const Ground& ground, const Params& p, const Box3d& area, Progress& progress)
      : p_(p),
        area_(area),
        random_(ground.site().seed, Stream::rooms),
        progress_(progress),
        planner_(ground, settings(ground, p, area), progress),
        hollow_(ground, p, p.radius) {}

  Result run() {
    place_rooms();
    join_rooms();
    open_mouths();
    Result result = hollow_.finish(progress_);
    std::vector<Vec3d> stands;
    for (const Room& room : rooms_) stands.push_back(room.stand);
    Facts facts;
    facts.places("entrances", opened_)
        .about("x, y and z of each way in from a hillside in turn")
        .places("chambers", stands)
        .about("x, y and z of a place to stand in each chamber in turn");
    facts.append(result.facts);
    result.facts = std::move(facts);
    if (opened_.empty() && p_.entrances > 0)
      progress_.warn("the hive has no entrance: no hillside here has room for a tunnel behind it");
    return result;
  }

 private:
  static impl::TunnelPlannerSettings settings(const Ground& ground, const Params& p, const Box3d& area) {
    impl::TunnelPlannerSettings s{p, area};
    s.slope = std::tan(p.slope * degree);
    s.lowest = area.lo.z + 1;
    s.seed = ground.site().seed;
    return s;
  }

  /// The floor that rooms are to have: about the middle of the hillsides.
  double wanted_floor() const {
    std::vector<double> heights;
    for (const impl::Mouth& m : planner_.mouths()) heights.push_back(m.ground.z);
    if (heights.empty()) return 1e9;
    const auto middle = heights.begin() + std::ssize(heights) * look::low_mouths / look::of_mouths;
    std::nth_element(heights.begin(), middle, heights.end());
    return *middle;
  }

  void place_rooms() {
    std::istringstream words(p_.kinds);
    std::vector<std::string> kinds;
    for (std::string word; words >> word;) kinds.push_back(word);
    if (kinds.empty()) kinds.push_back("hall");
    const double target = wanted_floor();
    const Vec3d extent = area_.size();
    for (std::int64_t i = 0; i < p_.chambers; ++i) {
      const volume::ChamberPreset& preset = volume::find_chamber_preset(kinds[i % std::ssize(kinds)]);
      const volume::ChamberLattice lattice = volume::parse_lattice(preset.lattice, preset.name);
      const double most = std::min(extent.x, extent.y) / (look::rooms_across * lattice.cells.x);
      for (const double shrink : look::shrinks) {
        volume::ChamberSettings s;
        s.cell = p_.cell > 0 ? p_.cell : shrink * std::min(preset.cell, most);
        s.noise = p_.chamber_noise;
        s.spacing = std::min(hollow_.spacing(), s.cell / look::samples_a_cell);
        s.seed = random_.next();
        if (place_room(lattice, s, target)) break;
      }
    }
  }

  bool place_room(const volume::ChamberLattice& lattice, volume::ChamberSettings s, double target) {
    const Vec3d size = Vec3d{1.0 * lattice.cells.x, 1.0 * lattice.cells.y, 1.0 * lattice.cells.z} * s.cell;
    const double around = 0.5 * std::hypot(size.x, size.y);
    double best = -1e30;
    for (int i = 0; i < look::places; ++i) {
      volume::ChamberSettings t = s;
      t.turn = random_.uniform(0, 1.5707963);
      Vec3d& at = t.position;
      at.x = random_.uniform(area_.lo.x, area_.hi.x);
      at.y = random_.uniform(area_.lo.y, area_.hi.y);
      const double merit = random_.uniform(0, look::chance);
      const double roof = planner_.roof(at.x, at.y, around) - p_.cover - size.z;
      at.z = std::min(roof, target - 0.5 * s.cell);
      if (at.z < area_.lo.z + look::under_room || !apart(at, around)) continue;
      // A room deep under a mountain is no better than a shallow one under a hill.
      const double worth = merit - look::height_loss * std::abs(at.z - std::min(target, 1e6));
      if (worth <= best) continue;
      best = worth;
      s = t;
    }
    if (best <= -1e30) return false;
    rooms_.push_back(room_of(lattice, s));
    return true;
  }

  bool apart(Vec3d at, double around) const {
    return std::all_of(rooms_.begin(), rooms_.end(), [&](const Room& other) {
      const Vec3d d = other.chamber.settings().position - at;
      const Vec3d size = other.chamber.size();
      return std::hypot(d.x, d.y) >
             around + 0.5 * std::hypot(size.x, size.y) + look::between_rooms * p_.radius;
    });
  }

  Room room_of(const volume::ChamberLattice& lattice, const volume::ChamberSettings& s) const {
    Room room{volume::Chamber(lattice, s), {}, s.position};
    const Vec3d size = room.chamber.size();
    for (int k = 0; k < 4; ++k) {
      const double a = s.turn + 1.57079632679 * k;
      const Vec3d out{std::cos(a), std::sin(a), 0};
      WayEnd door;
      door.floor = s.position + out * (0.5 * (k % 2 ? size.y : size.x) - look::door_inset * s.cell) +
                   Vec3d{0, 0, look::door_height * s.cell};
      door.ahead = out;
      door.straight = look::door_inset * s.cell + look::door_straight * p_.radius;
      room.doors.push_back(door);
    }
    while (room.chamber.value(room.stand) >= 0 && room.stand.z < s.position.z + size.z)
      room.stand.z += look::floor_step;
    return room;
  }

  /// Whether a way would cut through a room other than at its doors.
  bool in_a_room(Vec3d p, const WayEnd& from, const WayEnd& to) const {
    return std::any_of(rooms_.begin(), rooms_.end(), [&](const Room& room) {
      if (!room.chamber.bounds().grown(p_.radius).contains(p)) return false;
      for (const WayEnd* end : {&from, &to})
        if (std::hypot(p.x - end->floor.x, p.y - end->floor.y) < end->straight + p_.radius) return false;
      return true;
    });
  }

  /// Digs a way from end to end; whether it could. A door is for one way: two would part in height before
  /// they part in place.
  bool dig(const WayEnd& from, const WayEnd& to) {
    progress_.check();
    const auto is_taken = [&](const WayEnd& end) {
      return std::find(taken_.begin(), taken_.end(), end.floor) != taken_.end();
    };
    if (is_taken(from) || is_taken(to)) return false;
    auto way = planner_.way(from, to, random_.next(), [&](Vec3d p) { return in_a_room(p, from, to); });
    if (!way) return false;
    planner_.keep_off(*way);
    taken_.insert(taken_.end(), {from.floor, to.floor});
    hollow_.add(std::move(*way));
    return true;
  }

  /// Digs a way between two rooms, from the doors that are nearest to each other if it can be; whether it
  /// could.
  bool join(const Room& a, const Room& b) {
    std::vector<std::pair<const WayEnd*, const WayEnd*>> pairs;
    for (const WayEnd& from : a.doors)
      for (const WayEnd& to : b.doors) pairs.emplace_back(&from, &to);
    std::stable_sort(pairs.begin(), pairs.end(), [](const auto& p, const auto& q) {
      return length(p.first->floor - p.second->floor) < length(q.first->floor - q.second->floor);
    });
    return std::any_of(pairs.begin(), pairs.begin() + look::door_pairs,
                       [&](const auto& pair) { return dig(*pair.first, *pair.second); });
  }

  /// Joins each room to the nearest of those before it, and the last to the first as a loop. A room to which
  /// no way leads is not dug.
  void join_rooms() {
    const std::vector<Room> placed = std::exchange(rooms_, {});
    for (const Room& room : placed) {
      std::vector<const Room*> order;
      for (const Room& other : rooms_) order.push_back(&other);
      std::stable_sort(order.begin(), order.end(), [&](const Room* a, const Room* b) {
        return length(a->stand - room.stand) < length(b->stand - room.stand);
      });
      if (!rooms_.empty() &&
          std::none_of(order.begin(), order.end(), [&](const Room* other) { return join(room, *other); }))
        continue;
      rooms_.push_back(room);
    }
    if (rooms_.size() > 2) join(rooms_.front(), rooms_.back());
    for (const Room& room : rooms_) hollow_.add(room.chamber);
  }

  /// Opens entrances, far from one another if there is a choice.
  void open_mouths() {
    const Vec3d extent = area_.size();
    int tries = 0;
    for (double far = look::mouths_apart * std::min(extent.x, extent.y); far > look::least_apart * p_.radius;
         far *= look::nearer)
      for (const impl::Mouth& mouth : planner_.mouths()) {
        if (std::ssize(opened_) >= p_.entrances || ++tries > look::mouth_tries) return;
        const auto near = [&](Vec3d other) { return length(other - mouth.ground) < far; };
        if (std::any_of(opened_.begin(), opened_.end(), near)) continue;
        if (open(mouth)) opened_.push_back(mouth.ground);
      }
  }

  bool open(const impl::Mouth& mouth) {
    const WayEnd from = planner_.end_of(mouth);
    if (rooms_.empty()) {
      const WayEnd to{from.floor + mouth.inward * (look::lone_tunnel * p_.radius), -mouth.inward, p_.radius,
                      false};
      return dig(from, to);
    }
    std::vector<const WayEnd*> doors;
    for (const Room& room : rooms_)
      for (const WayEnd& door : room.doors) doors.push_back(&door);
    std::stable_sort(doors.begin(), doors.end(), [&](const WayEnd* a, const WayEnd* b) {
      return length(a->floor - mouth.ground) < length(b->floor - mouth.ground);
    });
    if (dot(doors.front()->floor - mouth.ground, mouth.inward) < 0) return false;
    return std::any_of(doors.begin(),
                       doors.begin() + std::min<std::ptrdiff_t>(look::mouth_doors, std::ssize(doors)),
                       [&](const WayEnd* door) { return dig(from, *door); });
  }

  const Params& p_;
  Box3d area_;
  Random random_;
  Progress& progress_;
  TunnelPlanner planner_;
  impl::Hollow hollow_;
  std::vector<Room> rooms_;
  std::vector<Vec3d> opened_;
  std::vector<Vec3d> taken_;  ///< doors and mouths, by their floors
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "hive");
  progress.check();
  const Ground ground(site);
  if (ground.box().empty()) {
    Result nothing;
    nothing.facts.places("entrances", {})
        .about("x, y and z of each way in from a hillside in turn")
        .count("primitives", 0);
    return nothing;
  }
  const Box3d area = impl::find_hive_area(ground, p.size, p.depth);
  Site crag = site;
  Result top;
  Region region = site.region ? *site.region : Region();
  if (p.noise > 0) {
    impl::FractalGroundSettings s;
    s.noise = p.noise;
    s.coarse = std::min(look::coarse, look::coarse_share * std::min(area.size().x, area.size().y));
    s.spacing = p.spacing > 0 ? p.spacing : look::ground_spacing * p.radius;
    s.seed = hash_combine(site.seed, Stream::ground);
    Site over = site;
    Box3d all = area;
    all.lo.z -= 1e5, all.hi.z += 1e5;
    region.limit_box(all);
    over.region = &region;
    const Ground under(over);
    top = impl::fractal_ground(under, s, progress).result;
    if (top.reshape) crag.terrain = top.reshape(site.terrain);
  }
  const Ground made(crag);
  Result result = Hive(made, p, area, progress).run();
  if (top.reshape) result.lowest = std::min(lowest_change(result), lowest_change(top));
  if (top.reshape && result.reshape)
    result.reshape = [first = top.reshape, then = result.reshape](field::NodePtr tree) {
      return then(first(std::move(tree)));
    };
  else if (top.reshape)
    result.reshape = top.reshape;
  result.reshaped.expand(top.reshaped);
  result.facts.count("primitives", 0);
  return result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "hive",
                .doc = "Rough ground with entrances on its hillsides, fractal tunnels and chambers, all "
                       "joined and walkable",
                .source = "[Ju01]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_hive
