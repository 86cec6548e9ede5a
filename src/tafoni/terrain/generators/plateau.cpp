// Karst country: a limestone plateau without streams, full of dolines, above a valley with a long cliff face
// and steepheads.

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/face.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/rows.h"
#include "tafoni/terrain/impl/valleys.h"

namespace tafoni::terrain::generator_plateau {
namespace {

using impl::PlaneNoise;
using impl::soft_min;

struct Plateau : GridSettings {
  Plateau() {
    width = height = 1040;
    pixel = 5;
  }
  double elevation = 300;
  double cliff = 230;
  double valley = 620;
  double gradient = 0.008;
  double steepheads = 0.9;
  double steephead_length = 1100;
  double hills = 70;
  double dolines = 16;
  double doline_size = 62;
  double roughness = 1;
};

const ParamTable<Plateau>& table() {
  static const ParamTable<Plateau> params = [] {
    ParamTable<Plateau> t;
    add_grid_params(t);
    t.real("elevation", &Plateau::elevation, "m", -1000, 8000,
           "Elevation of the valley where it leaves the map")
        .real("cliff", &Plateau::cliff, "m", 5, 2000, "Height of the plateau's edge above the valley")
        .real("valley", &Plateau::valley, "m", 10, 20000, "Width of the valley's floor")
        .real("gradient", &Plateau::gradient, "", 0, 0.2,
              "Fall of the valley, metres per metre; 0 for a level one")
        .real("steepheads", &Plateau::steepheads, "1/km", 0, 20,
              "Steepheads per km of valley: short valleys with a steep head that cut into the plateau; 0 for "
              "none")
        .real("steephead_length", &Plateau::steephead_length, "m", 10, 20000, "Mean length of a steephead")
        .only("where steepheads is above 0")
        .real("hills", &Plateau::hills, "m", 0, 1000,
              "Relief of the plateau: hills, and dry valleys between them; 0 for a level one")
        .real("dolines", &Plateau::dolines, "1/km2", 0, 500,
              "Sinkholes per square kilometre of plateau; 0 for none")
        .real("doline_size", &Plateau::doline_size, "m", 1, 2000,
              "Mean radius of a sinkhole; wide ones are deep ones too")
        .only("where dolines is above 0")
        .real("roughness", &Plateau::roughness, "", 0, 4,
              "Strength of small relief: 0 for smooth ground, 4 for broken rock");
    return t;
  }();
  return params;
}

enum class Stream : std::uint64_t {
  valleys = 1,
  warp_x = 5,
  warp_y = 6,
  clusters = 7,
  flutes = 8,
  grain = 9,
  floor = 10,
  dolines = 14,
  hills = 20,
  knolls = 21,
  dry_valleys = 22,
  soil = 23,
  wobble = 24
};

/// Chosen by eye after maps of karst plateaus; metres where nothing else is said.
namespace look {
constexpr double valley_place = 0.16;                     // of the map: how far in the south the valley runs
constexpr double valley_bends = 5.5;                      // valley widths from bend to like bend
constexpr double valley_swing = 0.5, valley_stray = 0.3;  // radians
constexpr double side_room = 0.28, side_bends = 0.8;      // of a steephead's length
constexpr double side_swing = 0.45, side_stray = 0.4;     // radians
constexpr double side_head = 0.45;                        // of the cliff: where the bed of a steephead ends
constexpr double side_steepening = 1.5;                   // its bed rises faster towards the head
constexpr double side_mouth = 0.09, side_end = 0.03;      // half widths, of the valley's width
constexpr double doline_tries = 2;                        // some are refused, so that many more are tried
constexpr double cluster_size = 1400, cluster_share = 1.1;  // dolines come in clusters
constexpr double collapsed = 0.2;                           // share of dolines with upright walls
constexpr double wall_run = 0.35;                         // of the radius: where a collapsed one's wall ends
constexpr double wobble_size = 130, wobble = 0.3;         // dolines are not round
constexpr double alcove_size = 420, alcove_depth = 0.24;  // of the cliff's height: bays of its line
constexpr double flute_size = 80, flute_depth = 5;        // joints that run straight up the face
constexpr double grain_size = 38, grain_depth = 4.5;      // blocks of the face
constexpr double foot = 0.2;                              // of the cliff's height: where flutes are full
constexpr double rim = 0.05;                              // of the cliff's height: rounding of the edge
constexpr double floor_size = 300, floor_share = 0.12;    // hummocks of the flood plain
constexpr double floor_depth = 0.25, floor_most = 0.1;    // fall to its stream; of its width, of the cliff
constexpr double hill_size = 2100, knoll_size = 330, soil_size = 45;
constexpr double knoll_share = 0.09, soil_share = 0.02;  // of the hills' relief
constexpr double dry_size = 2600, dry_width = 0.16,
                 dry_depth = 0.5;  // dry valleys; depth of the hills' relief
constexpr double back_rise = 0.3;  // of the cliff: the plateau rises behind its edge
}  // namespace look

struct Doline {
  Vec2d center;
  double radius, depth;
  bool collapsed;
};

class Builder {
 public:
  Builder(const Plateau& p, std::uint64_t seed)
      : p_(p),
        seed_(seed),
        extent_(p.extent()),
        face_(2 * p.cliff + p.hills + 20, beds(), seed),
        rim_(face_.reach(p.cliff)) {}

  raster::Raster run(Progress& progress) {
    progress.check();
    const impl::ValleyMap map = valleys();
    place_dolines(map);
    return impl::by_rows(p_, "plateau", progress,
                         [&](int, const Points& points, std::span<double> out) { relief(map, points, out); });
  }

 private:
  using Points = std::vector<Vec2d>;

  /// A broad apron of scree below cliffs that few ledges break.
  impl::FaceBeds beds() const {
    const double c = p_.cliff;
    return {.hard_thickness = {0.2 * c, 0.45 * c},
            .hard_run = {0.12, 0.26},
            .soft_thickness = {0.02 * c, 0.05 * c},
            .soft_run = {0.9, 1.8},
            .foot = 0.36 * c,
            .foot_run = 1.75};
  }

  impl::ValleyMap valleys() const {
    impl::Valleys valleys(extent_, impl::river_step(p_), hash_combine(seed_, Stream::valleys));
    valleys.add_main(look::valley_place, 0, p_.gradient, 0.5 * p_.valley,
                     {look::valley_bends * p_.valley, look::valley_swing, look::valley_stray}, false);
    impl::SideValleys sides;
    sides.per_km = p_.steepheads;
    sides.length[0] = 0.5 * p_.steephead_length;
    sides.length[1] = 1.5 * p_.steephead_length;
    sides.apart = look::side_room * p_.steephead_length;
    sides.head = look::side_head * p_.cliff;
    sides.steepening = look::side_steepening;
    sides.falls = 0;
    sides.half_width[0] = look::side_mouth * p_.valley;
    sides.half_width[1] = look::side_end * p_.valley;
    sides.winding = {look::side_bends * p_.steephead_length, look::side_swing, look::side_stray};
    valleys.add_sides(sides, 1);
    return {valleys.rivers(), face_, impl::placement_of(p_), p_.columns(), p_.rows()};
  }

  PlaneNoise noise(double wavelength, int octaves, Stream stream) const {
    return {wavelength, octaves, seed_, stream};
  }

  /// Dolines come in clusters, and none lie near the edge, where water finds its way out.
  void place_dolines(const impl::ValleyMap& map) {
    Random random(seed_, Stream::dolines);
    const double area = extent_.x * extent_.y / 1e6;
    const int tries = round_to(std::min(1e5, look::doline_tries * p_.dolines * area));
    const PlaneNoise clusters = noise(look::cluster_size, 2, Stream::clusters);
    for (int k = 0; k < tries; ++k) {
      const Vec2d c{random.uniform(0, extent_.x), random.uniform(0, extent_.y)};
      const double size = random.uniform() * random.uniform();
      const double radius = p_.doline_size * (0.5 + 2.2 * size);
      const Doline doline{c, radius, radius * random.uniform(0.22, 0.42), random.uniform() < look::collapsed};
      const bool wanted = random.uniform() < 0.5 + look::cluster_share * clusters.at(c);
      if (wanted && map.at(c).reach > rim_ + radius + 0.2 * p_.cliff) dolines_.push_back(doline);
    }
  }

  std::vector<Doline> near(double y) const {
    std::vector<Doline> out;
    for (const Doline& d : dolines_)
      if (std::abs(d.center.y - y) < 1.5 * d.radius) out.push_back(d);
    return out;
  }

  static double depth(const Doline& d, Vec2d p, double wobble) {
    const double r = std::hypot(p.x - d.center.x, p.y - d.center.y) / d.radius * (1 + look::wobble * wobble);
    if (r >= 1) return 0;
    return d.depth *
           (d.collapsed ? 1.4 * smoothstep(0.0, look::wall_run, 1 - r) : smoothstep(0.0, 1.0, 1 - r));
  }

  void relief(const impl::ValleyMap& map, const Points& points, std::span<double> out) const {
    const std::size_t n = points.size();
    Points feet(n);
    const auto wx = noise(look::alcove_size, 4, Stream::warp_x).at(points),
               wy = noise(look::alcove_size, 4, Stream::warp_y).at(points);
    std::vector<impl::ValleyMap::Place> places(n);
    for (std::size_t i = 0; i < n; ++i) {
      places[i] = map.at(points[i] +
                         Vec2d{wx[i], wy[i]} * (look::alcove_depth * p_.cliff * std::min(p_.roughness, 2.0)));
      feet[i] = places[i].river->position;
    }
    const auto flutes = noise(look::flute_size, 2, Stream::flutes).at(feet),
               grain = noise(look::grain_size, 4, Stream::grain).at(points);
    const auto floor = noise(look::floor_size, 3, Stream::floor).at(points);
    const auto top = plateau(points, places);
    for (std::size_t i = 0; i < n; ++i) {
      const impl::ValleyMap::Place& at = places[i];
      const double bed = at.river->bed + valley_floor(at, floor[i]);
      const double up = smoothstep(0.0, look::foot * p_.cliff + p_.pixel, at.off_bank);
      const double flute = p_.roughness * up *
                           (look::grain_depth * grain[i] + look::flute_depth * (std::abs(flutes[i]) - 0.35));
      const double wall = at.off_bank > 0 ? std::max(face_.height(at.reach + flute), bed) : bed;
      out[i] = p_.elevation + soft_min(wall, std::max(top[i], bed), look::rim * p_.cliff);
    }
  }

  /// Height above the bed: a flood plain falls to a stream in its middle.
  double valley_floor(const impl::ValleyMap::Place& at, double floor) const {
    const double t = 1 + std::min(at.off_bank, 0.0) / at.river->half_width;
    const double room = std::min(at.river->half_width, look::floor_most * p_.cliff);
    return room * (look::floor_depth * t * t + look::floor_share * p_.roughness * floor * t * (1 - t)) -
           look::floor_depth * room;
  }

  /// Gentle hills, dry valleys that lead to the edge, and dolines.
  std::vector<double> plateau(const Points& points, const std::vector<impl::ValleyMap::Place>& places) const {
    const auto hills = noise(look::hill_size, 4, Stream::hills).at(points),
               knolls = noise(look::knoll_size, 4, Stream::knolls).at(points);
    const auto dry = noise(look::dry_size, 2, Stream::dry_valleys).at(points),
               soil = noise(look::soil_size, 4, Stream::soil).at(points);
    const auto wobble = noise(look::wobble_size, 2, Stream::wobble).at(points);
    const auto dolines = near(points.front().y);
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double back = std::max(0.0, places[i].reach - 0.8 * rim_);
      double h = p_.cliff + p_.hills * (0.55 * hills[i] + 0.45) +
                 look::knoll_share * p_.hills * p_.roughness * knolls[i] +
                 look::soil_share * p_.hills * p_.roughness * soil[i] +
                 look::back_rise * p_.cliff * (1 - std::exp(-back / (3 * p_.cliff)));
      const double valley = smoothstep(0.0, 1.0, 1 - std::abs(dry[i]) / look::dry_width);
      h -= look::dry_depth * p_.hills * valley * std::exp(-back / (8 * p_.cliff));
      double hole = 0;
      for (const Doline& d : dolines)
        if (std::abs(points[i].x - d.center.x) < 1.5 * d.radius)
          hole = std::max(hole, depth(d, points[i], wobble[i]));
      out[i] = h - hole;
    }
    return out;
  }

  Plateau p_;
  std::uint64_t seed_;
  Vec2d extent_;
  impl::Face face_;
  double rim_;
  std::vector<Doline> dolines_;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Plateau p;
  assign(table().infos(), &p, values, "plateau");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& declaration() {
  static const GeneratorType type{
      .about = {.name = "plateau",
                .doc = "Karst country: a plateau with dolines above a valley and a long cliff",
                .source = "a composition of sine-generated rivers, bedded faces and closed hollows",
                .params = table()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain::generator_plateau
