// A mesa of bedded sandstone that a winding river has cut, with side canyons that rise over dry falls to the
// slickrock domes on top.

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/face.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/rows.h"
#include "tafoni/terrain/impl/valleys.h"

namespace tafoni::terrain {
namespace {

using impl::PlaneNoise;
using impl::smooth;
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
           "elevation of the river at the map's southern edge")
        .real("relief", &Canyon::relief, "m", 5, 3000, "height of the mesa above the river")
        .real("river", &Canyon::river, "m", 1, 2000, "width of the river's bed")
        .real("gradient", &Canyon::gradient, "", 0, 0.2, "fall of the river, metres per metre")
        .real("meander", &Canyon::meander, "m", 20, 50000, "length of the river from bend to like bend")
        .real("swing", &Canyon::swing, "deg", 0, 100, "how far the river turns to either side")
        .real("sides", &Canyon::sides, "1/km", 0, 40, "side canyons per km of river")
        .real("side_length", &Canyon::side_length, "m", 10, 20000, "mean length of a side canyon")
        .real("branches", &Canyon::branches, "1/km", 0, 40, "branches per km of side canyon")
        .real("domes", &Canyon::domes, "m", 0, 500, "height of the domes on the mesa")
        .real("roughness", &Canyon::roughness, "", 0, 4, "strength of small relief");
    return t;
  }();
  return params;
}

class Builder {
 public:
  Builder(const Canyon& p, std::uint64_t seed)
      : p_(p),
        seed_(seed),
        extent_{p.pixel * static_cast<double>(p.width), p.pixel * static_cast<double>(p.height)},
        placement_{0, extent_.y, p.pixel, p.pixel},
        face_(1.5 * (p.relief + p.domes) + 20, beds(), seed) {}

  raster::Raster run(Progress& progress) {
    progress.check();
    const impl::ValleyMap map = valleys();
    return impl::by_rows(p_, "canyon", progress,
                         [&](int row, const raster::Placement&, float* out) { relief(map, row, out); });
  }

 private:
  /// Cliffs of massive sandstone between thin ledges, over an apron of scree.
  impl::FaceBeds beds() const {
    const double d = p_.relief;
    return {{0.10 * d, 0.26 * d}, {0.10, 0.24}, {0.012 * d, 0.04 * d}, {0.9, 2.2}, 0.03 * d, 0.9};
  }

  impl::ValleyMap valleys() const {
    impl::Valleys valleys(extent_, std::max(0.7 * p_.pixel, (extent_.x + extent_.y) / 20000),
                          hash_combine(seed_, 1));
    const double swing = p_.swing * 3.14159265358979323846 / 180;
    valleys.add_main(0.5, 0, p_.gradient, 0.5 * p_.river, {p_.meander, swing, 0.35}, true);
    impl::SideValleys sides;
    sides.per_km = p_.sides;
    sides.length[0] = 0.5 * p_.side_length;
    sides.length[1] = 1.5 * p_.side_length;
    sides.apart = 0.17 * p_.side_length;
    sides.head = 0.96 * p_.relief;
    sides.steepening = 1.7;
    sides.half_width[0] = 0.3 * p_.river;
    sides.half_width[1] = 0.05 * p_.river;
    sides.winding = {0.3 * p_.meander, 0.6, 0.5};
    valleys.add_sides(sides, 1);
    sides.per_km = p_.branches;
    sides.length[0] *= 0.4;
    sides.length[1] *= 0.4;
    sides.apart *= 0.7;
    sides.falls = 3;
    sides.winding.wavelength *= 0.6;
    valleys.add_sides(sides, 2);
    return impl::ValleyMap(valleys.rivers(), face_, placement_, static_cast<int>(p_.width),
                           static_cast<int>(p_.height));
  }

  std::vector<double> noise(double wavelength, int octaves, std::uint64_t stream,
                            const std::vector<Vec2d>& points) const {
    return PlaneNoise(wavelength, octaves, hash_combine(seed_, stream)).at(points);
  }

  void relief(const impl::ValleyMap& map, int row, float* out) const {
    const auto n = static_cast<std::size_t>(p_.width);
    std::vector<Vec2d> points(n), feet(n);
    for (std::size_t i = 0; i < n; ++i) points[i] = placement_.center(static_cast<double>(i), row);
    // Buttresses and alcoves of the walls; the river itself keeps its course.
    const auto wx = noise(75, 3, 5, points), wy = noise(75, 3, 6, points);
    std::vector<impl::ValleyMap::Place> places(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double away = smooth((map.at(points[i]).off_bank - 2) / 30);
      places[i] = map.at(points[i] + Vec2d{wx[i], wy[i]} * (11 * p_.roughness * away));
      feet[i] = places[i].river->position;
    }
    // What depends on the river point below runs straight up the wall, as joints do.
    const auto flutes = noise(17, 2, 7, feet), grain = noise(9, 4, 8, points);
    const auto bars = noise(14, 3, 9, points);
    const auto summit = mesa(points, places);
    for (std::size_t i = 0; i < n; ++i) {
      const impl::ValleyMap::Place& at = places[i];
      if (at.off_bank <= 0) {
        out[i] = static_cast<float>(p_.elevation + bed(at, bars[i]));
        continue;
      }
      const double up = smooth(at.off_bank / 12);
      const double flute = p_.roughness * up * (1.1 * grain[i] + 1.6 * (std::abs(flutes[i]) - 0.35));
      const double wall = face_.height(at.reach + flute);
      const double least = at.river->bed + 0.05 * at.off_bank;
      const double h = soft_min(std::max(wall, least), std::max(summit[i], least + 1), 0.06 * p_.relief);
      out[i] = static_cast<float>(p_.elevation + std::max(h, least));
    }
  }

  /// A shallow channel between low bars.
  double bed(const impl::ValleyMap::Place& at, double bars) const {
    const double t = 1 + at.off_bank / at.river->half_width;
    const double deep = std::min(0.12 * at.river->half_width, 1.0);
    return at.river->bed - deep * (1 - t * t) * (1 + 0.4 * p_.roughness * bars);
  }

  /// Cross-bedded domes with hollows between them, lower towards the canyons.
  std::vector<double> mesa(const std::vector<Vec2d>& points,
                           const std::vector<impl::ValleyMap::Place>& places) const {
    const auto hills = noise(420, 2, 10, points), domes = noise(330, 2, 11, points);
    const auto knobs = noise(110, 2, 12, points), grain = noise(10, 4, 13, points);
    const double rim = face_.reach(p_.relief);
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double dome = 1 - std::abs(domes[i]), knob = std::abs(knobs[i]);
      const double back = std::max(0.0, places[i].reach - 0.7 * rim);
      out[i] = p_.relief * (1 + 0.06 * hills[i]) + p_.gradient * points[i].y +
               p_.domes * (0.75 * (1 - dome * dome) + 0.16 * knob) + 0.5 * p_.roughness * grain[i] +
               0.10 * p_.relief * (1 - std::exp(-back / (0.5 * p_.relief))) - 0.1 * p_.relief;
    }
    return out;
  }

  Canyon p_;
  std::uint64_t seed_;
  Vec2d extent_;
  raster::Placement placement_;
  impl::Face face_;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Canyon p;
  assign(table().infos(), &p, values, "canyon");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& generator_canyon() {
  static const GeneratorType type{
      .about = {.name = "canyon",
                .doc = "A mesa cut by a winding river with side canyons, as at Zion",
                .source = "a composition of sine-generated rivers and bedded faces",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain
