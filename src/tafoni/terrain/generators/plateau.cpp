// Karst country: a limestone plateau without streams, full of dolines, above a valley with a long cliff face
// and steepheads.

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
           "elevation of the valley where it leaves the map")
        .real("cliff", &Plateau::cliff, "m", 5, 2000, "height of the plateau's edge above the valley")
        .real("valley", &Plateau::valley, "m", 10, 20000, "width of the valley's floor")
        .real("gradient", &Plateau::gradient, "", 0, 0.2, "fall of the valley, metres per metre")
        .real("steepheads", &Plateau::steepheads, "1/km", 0, 20,
              "short valleys with steep heads that cut into the plateau, per km of valley")
        .real("steephead_length", &Plateau::steephead_length, "m", 10, 20000, "mean length of such a valley")
        .real("hills", &Plateau::hills, "m", 0, 1000, "relief of the plateau")
        .real("dolines", &Plateau::dolines, "1/km2", 0, 500, "sinkholes per square kilometre of plateau")
        .real("doline_size", &Plateau::doline_size, "m", 1, 2000, "mean radius of a sinkhole")
        .real("roughness", &Plateau::roughness, "", 0, 4, "strength of small relief");
    return t;
  }();
  return params;
}

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
        extent_{p.pixel * static_cast<double>(p.width), p.pixel * static_cast<double>(p.height)},
        placement_{0, extent_.y, p.pixel, p.pixel},
        face_(2 * p.cliff + p.hills + 20, beds(), seed),
        rim_(face_.reach(p.cliff)) {}

  raster::Raster run(Progress& progress) {
    progress.check();
    const impl::ValleyMap map = valleys();
    place_dolines(map);
    return impl::by_rows(p_, "plateau", progress,
                         [&](int row, const raster::Placement&, float* out) { relief(map, row, out); });
  }

 private:
  /// A broad apron of scree below cliffs that few ledges break.
  impl::FaceBeds beds() const {
    const double c = p_.cliff;
    return {{0.2 * c, 0.45 * c}, {0.12, 0.26}, {0.02 * c, 0.05 * c}, {0.9, 1.8}, 0.36 * c, 1.75};
  }

  impl::ValleyMap valleys() const {
    const double step = std::max(0.7 * p_.pixel, (extent_.x + extent_.y) / 20000);
    impl::Valleys valleys(extent_, step, hash_combine(seed_, 1));
    valleys.add_main(0.16, 0, p_.gradient, 0.5 * p_.valley, {5.5 * p_.valley, 0.5, 0.3}, false);
    impl::SideValleys sides;
    sides.per_km = p_.steepheads;
    sides.length[0] = 0.5 * p_.steephead_length;
    sides.length[1] = 1.5 * p_.steephead_length;
    sides.apart = 0.28 * p_.steephead_length;
    sides.head = 0.45 * p_.cliff;
    sides.steepening = 1.5;
    sides.falls = 0;
    sides.half_width[0] = 0.09 * p_.valley;
    sides.half_width[1] = 0.03 * p_.valley;
    sides.winding = {0.8 * p_.steephead_length, 0.45, 0.4};
    valleys.add_sides(sides, 1);
    return impl::ValleyMap(valleys.rivers(), face_, placement_, static_cast<int>(p_.width),
                           static_cast<int>(p_.height));
  }

  PlaneNoise noise(double wavelength, int octaves, std::uint64_t stream) const {
    return {wavelength, octaves, hash_combine(seed_, stream)};
  }

  /// In clusters, and none near the edge, where water finds its way out.
  void place_dolines(const impl::ValleyMap& map) {
    Random random(seed_, 14);
    const double area = extent_.x * extent_.y / 1e6;
    const auto tries = static_cast<std::size_t>(std::min(1e5, std::round(2 * p_.dolines * area)));
    const PlaneNoise clusters = noise(1400, 2, 7);
    for (std::size_t k = 0; k < tries; ++k) {
      const Vec2d c{random.uniform(0, extent_.x), random.uniform(0, extent_.y)};
      const double size = random.uniform() * random.uniform();
      const double radius = p_.doline_size * (0.5 + 2.2 * size);
      const Doline doline{c, radius, radius * random.uniform(0.22, 0.42), random.uniform() < 0.2};
      const bool wanted = random.uniform() < 0.5 + 1.1 * clusters.at(c);
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
    const double r = std::hypot(p.x - d.center.x, p.y - d.center.y) / d.radius * (1 + 0.3 * wobble);
    if (r >= 1) return 0;
    return d.depth * (d.collapsed ? 1.4 * smooth((1 - r) / 0.35) : smooth(1 - r));
  }

  void relief(const impl::ValleyMap& map, int row, float* out) const {
    const auto n = static_cast<std::size_t>(p_.width);
    std::vector<Vec2d> points(n), feet(n);
    for (std::size_t i = 0; i < n; ++i) points[i] = placement_.center(static_cast<double>(i), row);
    const auto wx = noise(420, 4, 5).at(points), wy = noise(420, 4, 6).at(points);
    std::vector<impl::ValleyMap::Place> places(n);
    for (std::size_t i = 0; i < n; ++i) {
      places[i] = map.at(points[i] + Vec2d{wx[i], wy[i]} * (0.24 * p_.cliff * std::min(p_.roughness, 2.0)));
      feet[i] = places[i].river->position;
    }
    const auto flutes = noise(80, 2, 8).at(feet), grain = noise(38, 4, 9).at(points);
    const auto floor = noise(300, 3, 10).at(points);
    const auto top = plateau(points, places);
    for (std::size_t i = 0; i < n; ++i) {
      const impl::ValleyMap::Place& at = places[i];
      const double bed = at.river->bed + valley_floor(at, floor[i]);
      const double up = smooth(at.off_bank / (0.2 * p_.cliff + p_.pixel));
      const double flute = p_.roughness * up * (4.5 * grain[i] + 5 * (std::abs(flutes[i]) - 0.35));
      const double wall = at.off_bank > 0 ? std::max(face_.height(at.reach + flute), bed) : bed;
      out[i] = static_cast<float>(p_.elevation + soft_min(wall, std::max(top[i], bed), 0.05 * p_.cliff));
    }
  }

  /// Above the bed: a flood plain that falls to a stream in its middle.
  double valley_floor(const impl::ValleyMap::Place& at, double floor) const {
    const double t = 1 + std::min(at.off_bank, 0.0) / at.river->half_width;
    const double room = std::min(at.river->half_width, 0.1 * p_.cliff);
    return room * (0.25 * t * t + 0.12 * p_.roughness * floor * t * (1 - t)) - 0.25 * room;
  }

  /// Gentle hills, dry valleys that lead to the edge, and dolines.
  std::vector<double> plateau(const std::vector<Vec2d>& points,
                              const std::vector<impl::ValleyMap::Place>& places) const {
    const auto hills = noise(2100, 4, 20).at(points), knolls = noise(330, 4, 21).at(points);
    const auto dry = noise(2600, 2, 22).at(points), grain = noise(45, 4, 23).at(points);
    const auto wobble = noise(130, 2, 24).at(points);
    const auto dolines = near(points.front().y);
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double back = std::max(0.0, places[i].reach - 0.8 * rim_);
      double h = p_.cliff + p_.hills * (0.55 * hills[i] + 0.45) + 0.09 * p_.hills * p_.roughness * knolls[i] +
                 0.02 * p_.hills * p_.roughness * grain[i] +
                 0.3 * p_.cliff * (1 - std::exp(-back / (3 * p_.cliff)));
      const double valley = smooth(1 - std::abs(dry[i]) / 0.16);
      h -= 0.5 * p_.hills * valley * std::exp(-back / (8 * p_.cliff));
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
  raster::Placement placement_;
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

const GeneratorType& generator_plateau() {
  static const GeneratorType type{
      .about = {.name = "plateau",
                .doc = "Karst country: a plateau with dolines above a valley and a long cliff",
                .source = "a composition of sine-generated rivers, bedded faces and closed hollows",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain
