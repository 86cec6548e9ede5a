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

/// A chamber with its four doors.
struct Room {
  volume::Chamber chamber;
  std::vector<WayEnd> doors;
  Vec3d stand;  ///< on its floor
};

class Hive {
 public:
  Hive(const Ground& ground, const Params& p, const Box3d& area, Progress& progress)
      : ground_(ground),
        p_(p),
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
    facts.places("entrances", opened_).places("chambers", stands);
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

  /// Where the middle of the hillsides is, so that ways are short and level.
  double wanted_floor() const {
    std::vector<double> heights;
    for (const impl::Mouth& m : planner_.mouths()) heights.push_back(m.ground.z);
    if (heights.empty()) return 1e9;
    const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() * 2 / 5);
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
      const volume::ChamberPreset& preset =
          volume::find_chamber_preset(kinds[static_cast<std::size_t>(i) % kinds.size()]);
      const volume::ChamberLattice lattice = volume::parse_lattice(preset.lattice, preset.name);
      const double most = std::min(extent.x, extent.y) / (2.5 * lattice.cells.x);
      for (const double shrink : {1.0, 0.75, 0.55}) {
        volume::ChamberSettings s;
        s.cell = p_.cell > 0 ? p_.cell : shrink * std::min(preset.cell, most);
        s.noise = p_.chamber_noise;
        s.spacing = std::min(hollow_.spacing(), s.cell / 4);
        s.seed = random_.next();
        if (place_room(lattice, s, target)) break;
      }
    }
  }

  bool place_room(const volume::ChamberLattice& lattice, volume::ChamberSettings s, double target) {
    const Vec3d size = Vec3d{1.0 * lattice.cells.x, 1.0 * lattice.cells.y, 1.0 * lattice.cells.z} * s.cell;
    const double around = 0.5 * std::hypot(size.x, size.y);
    double best = -1e30;
    for (int i = 0; i < 500; ++i) {
      volume::ChamberSettings t = s;
      t.turn = random_.uniform(0, 1.5707963);
      Vec3d& at = t.position;
      at.x = random_.uniform(area_.lo.x, area_.hi.x);
      at.y = random_.uniform(area_.lo.y, area_.hi.y);
      const double merit = random_.uniform(0, 6);
      const double roof = planner_.roof(at.x, at.y, around) - p_.cover - size.z;
      at.z = std::min(roof, target - 0.5 * s.cell);
      if (at.z < area_.lo.z + 2 || !apart(at, around)) continue;
      // Deep under a mountain is no better than shallow under a hill.
      const double worth = merit - 0.7 * std::abs(at.z - std::min(target, 1e6));
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
      return std::hypot(d.x, d.y) > around + 0.5 * std::hypot(size.x, size.y) + 6 * p_.radius;
    });
  }

  Room room_of(const volume::ChamberLattice& lattice, const volume::ChamberSettings& s) const {
    Room room{volume::Chamber(lattice, s), {}, s.position};
    const Vec3d size = room.chamber.size();
    for (int k = 0; k < 4; ++k) {
      const double a = s.turn + 1.57079632679 * k;
      const Vec3d out{std::cos(a), std::sin(a), 0};
      WayEnd door;
      door.floor =
          s.position + out * (0.5 * (k % 2 ? size.y : size.x) - 1.4 * s.cell) + Vec3d{0, 0, 0.55 * s.cell};
      door.ahead = out;
      door.straight = 1.4 * s.cell + 2.5 * p_.radius;
      room.doors.push_back(door);
    }
    while (room.chamber.value(room.stand) >= 0 && room.stand.z < s.position.z + size.z) room.stand.z += 0.1;
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

  /// A door is for one way: two would part in height before they part in place.
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

  /// The doors of both rooms that are nearest to each other first.
  bool join(const Room& a, const Room& b) {
    std::vector<std::pair<const WayEnd*, const WayEnd*>> pairs;
    for (const WayEnd& from : a.doors)
      for (const WayEnd& to : b.doors) pairs.emplace_back(&from, &to);
    std::stable_sort(pairs.begin(), pairs.end(), [](const auto& p, const auto& q) {
      return length(p.first->floor - p.second->floor) < length(q.first->floor - q.second->floor);
    });
    return std::any_of(pairs.begin(), pairs.begin() + 9,
                       [&](const auto& pair) { return dig(*pair.first, *pair.second); });
  }

  /// Each to the nearest before it, and a loop. A room to which no way leads is not dug.
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

  /// Mouths are far from one another if there is a choice.
  void open_mouths() {
    const Vec3d extent = area_.size();
    int tries = 0;
    for (double far = 0.35 * std::min(extent.x, extent.y); far > 4 * p_.radius; far *= 0.6)
      for (const impl::Mouth& mouth : planner_.mouths()) {
        if (std::ssize(opened_) >= p_.entrances || ++tries > 600) return;
        const auto near = [&](Vec3d other) { return length(other - mouth.ground) < far; };
        if (std::any_of(opened_.begin(), opened_.end(), near)) continue;
        if (open(mouth)) opened_.push_back(mouth.ground);
      }
  }

  bool open(const impl::Mouth& mouth) {
    const WayEnd from = planner_.end_of(mouth);
    if (rooms_.empty()) {
      const WayEnd to{from.floor + mouth.inward * (16 * p_.radius), -mouth.inward, p_.radius, false};
      return dig(from, to);
    }
    std::vector<const WayEnd*> doors;
    for (const Room& room : rooms_)
      for (const WayEnd& door : room.doors) doors.push_back(&door);
    std::stable_sort(doors.begin(), doors.end(), [&](const WayEnd* a, const WayEnd* b) {
      return length(a->floor - mouth.ground) < length(b->floor - mouth.ground);
    });
    if (dot(doors.front()->floor - mouth.ground, mouth.inward) < 0) return false;
    return std::any_of(doors.begin(), doors.begin() + std::min<std::ptrdiff_t>(6, std::ssize(doors)),
                       [&](const WayEnd* door) { return dig(from, *door); });
  }

  const Ground& ground_;
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
    nothing.facts.places("entrances", {}).count("primitives", 0);
    return nothing;
  }
  const Box3d area = impl::find_hive_area(ground, p.size, p.depth);
  Site crag = site;
  Result top;
  Region region = site.region ? *site.region : Region();
  if (p.noise > 0) {
    impl::FractalGroundSettings s;
    s.noise = p.noise;
    s.coarse = std::min(40.0, 0.25 * std::min(area.size().x, area.size().y));
    s.spacing = p.spacing > 0 ? p.spacing : 0.3 * p.radius;
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
