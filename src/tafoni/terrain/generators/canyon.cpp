// A mesa of bedded sandstone that a winding river has cut, with side canyons that rise over dry falls to the
// slickrock domes on top.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/face.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/rows.h"
#include "tafoni/terrain/impl/valleys.h"

namespace tafoni::terrain::generator_canyon {
namespace {

using impl::PlaneNoise;
using impl::soft_min;

struct Canyon : GridSettings {
  Canyon() { width = height = 1100; }
  double elevation = 1300;
  double relief = 260;
  double river = 14;
  double gradient = 0.02;
  double meander = 520;
  double swing = 48;
  double sides = 9;
  double side_length = 330;
  double branches = 7;
  double domes = 34;
  double roughness = 1;
};

const ParamTable<Canyon>& table() {
  static const ParamTable<Canyon> params = [] {
    ParamTable<Canyon> t;
    add_grid_params(t);
    t.real("elevation", &Canyon::elevation, "m", -1000, 8000,
           "Elevation of the river at the map's southern edge")
        .real("relief", &Canyon::relief, "m", 5, 3000, "Height of the mesa above the river")
        .real("river", &Canyon::river, "m", 1, 2000, "Width of the river's bed")
        .real("gradient", &Canyon::gradient, "", 0, 0.2,
              "Fall of the river, metres per metre; the mesa rises with it to the north")
        .real("meander", &Canyon::meander, "m", 20, 50000,
              "Length of the river from one bend to the next of the same hand")
        .real("swing", &Canyon::swing, "deg", 0, 100,
              "How far the river turns to either side: 0 runs straight, 100 nearly back on itself")
        .real("sides", &Canyon::sides, "1/km", 0, 40,
              "Side canyons per km of river, as far as there is room; 0 for none")
        .real("side_length", &Canyon::side_length, "m", 10, 20000,
              "Mean length of a side canyon; branches have a share of it, and long ones keep farther apart")
        .only("where sides or branches is above 0")
        .real("branches", &Canyon::branches, "1/km", 0, 40,
              "Short canyons per km of river and of side canyon, as far as there is room; 0 for none")
        .real("domes", &Canyon::domes, "m", 0, 500, "Height of the domes on the mesa; 0 for a level top")
        .real("roughness", &Canyon::roughness, "", 0, 4,
              "Strength of small relief: 0 for smooth walls, 4 for ragged ones");
    return t;
  }();
  return params;
}

enum class Stream : std::uint64_t {
  rivers = 1,
  warp_x = 5,
  warp_y = 6,
  flutes = 7,
  grain = 8,
  bars = 9,
  hills = 10,
  domes = 11,
  knobs = 12,
  slickrock = 13
};

/// Chosen by eye after photographs of Zion; metres where nothing else is said.
namespace look {
constexpr double stray = 0.35;                          // radians that the river's course wanders
constexpr double side_stray = 0.5, side_swing = 0.6;    // and a side canyon's, and how far it turns
constexpr double side_bends = 0.3, branch_bends = 0.6;  // their meanders, as a share of their river's
constexpr double side_head = 0.96;                      // of the relief: where side canyons begin
constexpr double side_room = 0.17, branch_room = 0.7;   // kept apart: of their length; of a side canyon's
constexpr double branch_length = 0.4;                   // of a side canyon's
constexpr double steepening = 1.7;                      // side canyons rise faster towards their heads
constexpr int branch_falls = 3;                         // dry falls in a branch
constexpr double side_mouth = 0.3, side_end = 0.05;     // half widths, as a share of the river's width
constexpr double alcove_size = 75, alcove_depth = 11;   // buttresses and alcoves of the walls
constexpr double calm = 2, calm_to = 30;              // off the bank: no alcoves at first, all of them later
constexpr double flute_size = 17, flute_depth = 1.6;  // joints that run straight up the wall
constexpr double wall_grain = 9, wall_roughness = 1.1;  // blocks of the wall
constexpr double foot = 12;                             // off the bank: where flutes have their full depth
constexpr double talus = 0.05;                          // least slope of what lies between bank and wall
constexpr double rim = 0.06;                            // of the relief: rounding of the rim
constexpr double bar_size = 14, bar_share = 0.4;        // bars of the bed, as a share of its depth
constexpr double bed_depth = 0.12, bed_most = 1.0;      // of the half width, and at most
constexpr double hill_size = 420, hill_relief = 0.06;   // swells of the mesa, as a share of the relief
constexpr double dome_size = 330, dome_share = 0.75;    // domes, as a share of their height …
constexpr double knob_size = 110, knob_share = 0.16;    // … and the knobs on them
constexpr double rock_size = 10, rock_relief = 0.5;     // slickrock
constexpr double lowering = 0.1;                        // of the relief: the mesa is lower near the canyons
}  // namespace look

class Builder {
 public:
  Builder(const Canyon& p, std::uint64_t seed)
      : p_(p), seed_(seed), extent_(p.extent()), face_(1.5 * (p.relief + p.domes) + 20, beds(), seed) {}

  raster::Raster run(Progress& progress) {
    progress.check();
    const impl::ValleyMap map = valleys();
    return impl::by_rows(p_, "canyon", progress,
                         [&](int, const Points& points, std::span<double> out) { relief(map, points, out); });
  }

 private:
  using Points = std::vector<Vec2d>;

  /// Cliffs of massive sandstone between thin ledges, over an apron of scree.
  impl::FaceBeds beds() const {
    const double d = p_.relief;
    return {.hard_thickness = {0.10 * d, 0.26 * d},
            .hard_run = {0.10, 0.24},
            .soft_thickness = {0.012 * d, 0.04 * d},
            .soft_run = {0.9, 2.2},
            .foot = 0.03 * d,
            .foot_run = 0.9};
  }

  impl::ValleyMap valleys() const {
    impl::Valleys valleys(extent_, impl::river_step(p_), hash_combine(seed_, Stream::rivers));
    const double swing = p_.swing * std::numbers::pi / 180;
    valleys.add_main(0.5, 0, p_.gradient, 0.5 * p_.river, {p_.meander, swing, look::stray}, true);
    impl::SideValleys sides;
    sides.per_km = p_.sides;
    sides.length[0] = 0.5 * p_.side_length;
    sides.length[1] = 1.5 * p_.side_length;
    sides.apart = look::side_room * p_.side_length;
    sides.head = look::side_head * p_.relief;
    sides.steepening = look::steepening;
    sides.half_width[0] = look::side_mouth * p_.river;
    sides.half_width[1] = look::side_end * p_.river;
    sides.winding = {look::side_bends * p_.meander, look::side_swing, look::side_stray};
    valleys.add_sides(sides, 1);
    sides.per_km = p_.branches;
    sides.length[0] *= look::branch_length;
    sides.length[1] *= look::branch_length;
    sides.apart *= look::branch_room;
    sides.falls = look::branch_falls;
    sides.winding.wavelength *= look::branch_bends;
    valleys.add_sides(sides, 2);
    return {valleys.rivers(), face_, impl::placement_of(p_), p_.columns(), p_.rows()};
  }

  std::vector<double> noise(double wavelength, int octaves, Stream stream, const Points& points) const {
    return PlaneNoise(wavelength, octaves, seed_, stream).at(points);
  }

  void relief(const impl::ValleyMap& map, const Points& points, std::span<double> out) const {
    const std::size_t n = points.size();
    Points feet(n);
    // Buttresses and alcoves of the walls; the river itself keeps its course.
    const auto wx = noise(look::alcove_size, 3, Stream::warp_x, points),
               wy = noise(look::alcove_size, 3, Stream::warp_y, points);
    std::vector<impl::ValleyMap::Place> places(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double away = smoothstep(0.0, look::calm_to, map.at(points[i]).off_bank - look::calm);
      places[i] = map.at(points[i] + Vec2d{wx[i], wy[i]} * (look::alcove_depth * p_.roughness * away));
      feet[i] = places[i].river->position;
    }
    // What depends on the river point below runs straight up the wall, as joints do.
    const auto flutes = noise(look::flute_size, 2, Stream::flutes, feet),
               grain = noise(look::wall_grain, 4, Stream::grain, points);
    const auto bars = noise(look::bar_size, 3, Stream::bars, points);
    const auto summit = mesa(points, places);
    for (std::size_t i = 0; i < n; ++i) {
      const impl::ValleyMap::Place& at = places[i];
      if (at.off_bank <= 0) {
        out[i] = p_.elevation + bed(at, bars[i]);
        continue;
      }
      const double up = smoothstep(0.0, look::foot, at.off_bank);
      const double flute =
          p_.roughness * up *
          (look::wall_roughness * grain[i] + look::flute_depth * (std::abs(flutes[i]) - 0.35));
      const double wall = face_.height(at.reach + flute);
      const double least = at.river->bed + look::talus * at.off_bank;
      const double h = soft_min(std::max(wall, least), std::max(summit[i], least + 1), look::rim * p_.relief);
      out[i] = p_.elevation + std::max(h, least);
    }
  }

  /// A shallow channel between low bars.
  double bed(const impl::ValleyMap::Place& at, double bars) const {
    const double t = 1 + at.off_bank / at.river->half_width;
    const double deep = std::min(look::bed_depth * at.river->half_width, look::bed_most);
    return at.river->bed - deep * (1 - t * t) * (1 + look::bar_share * p_.roughness * bars);
  }

  /// Cross-bedded domes with hollows between them, lower towards the canyons.
  std::vector<double> mesa(const Points& points, const std::vector<impl::ValleyMap::Place>& places) const {
    const auto hills = noise(look::hill_size, 2, Stream::hills, points),
               domes = noise(look::dome_size, 2, Stream::domes, points);
    const auto knobs = noise(look::knob_size, 2, Stream::knobs, points),
               grain = noise(look::rock_size, 4, Stream::slickrock, points);
    const double rim = face_.reach(p_.relief);
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double dome = 1 - std::abs(domes[i]), knob = std::abs(knobs[i]);
      const double back = std::max(0.0, places[i].reach - 0.7 * rim);
      out[i] = p_.relief * (1 + look::hill_relief * hills[i]) + p_.gradient * points[i].y +
               p_.domes * (look::dome_share * (1 - dome * dome) + look::knob_share * knob) +
               look::rock_relief * p_.roughness * grain[i] +
               look::lowering * p_.relief * (1 - std::exp(-back / (0.5 * p_.relief))) -
               look::lowering * p_.relief;
    }
    return out;
  }

  Canyon p_;
  std::uint64_t seed_;
  Vec2d extent_;
  impl::Face face_;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Canyon p;
  assign(table().infos(), &p, values, "canyon");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& declaration() {
  static const GeneratorType type{
      .about = {.name = "canyon",
                .doc = "A mesa cut by a winding river with side canyons, as at Zion",
                .source = "a composition of sine-generated rivers and bedded faces",
                .params = table()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain::generator_canyon
