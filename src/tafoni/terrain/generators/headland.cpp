// A headland of bedded limestone between two coves: a level plateau that ends in upright cliffs over shallow
// water.

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/rows.h"

namespace tafoni::terrain::generator_headland {
namespace {

using impl::PlaneNoise;

struct Headland : GridSettings {
  Headland() { width = height = 400; }
  double elevation = 24;
  double reach = 70;
  double breadth = 140;
  double cliff = 5;
  double bed = 4;
  double sea_depth = 6;
  double beach = 22;
  double roughness = 1;
};

const ParamTable<Headland>& table() {
  static const ParamTable<Headland> params = [] {
    ParamTable<Headland> t;
    add_grid_params(t);
    t.real("elevation", &Headland::elevation, "m", 1, 1000, "Height of the plateau above the sea")
        .real("reach", &Headland::reach, "m", 0, 5000,
              "How far the headland reaches out beyond the coves; 0 for a straight shore")
        .real("breadth", &Headland::breadth, "m", 5, 20000, "Breadth of the headland, from cove to cove")
        .real("cliff", &Headland::cliff, "m", 0.5, 500,
              "Width of the cliffs on the map: little for upright ones")
        .real("bed", &Headland::bed, "m", 0.2, 200,
              "Thickness of the beds, each of which is a step of the cliffs")
        .real("sea_depth", &Headland::sea_depth, "m", 0, 500, "Depth of the water some way off the cliffs")
        .real("beach", &Headland::beach, "m", 0, 500, "Width of the beaches in the coves; 0 for none")
        .real("roughness", &Headland::roughness, "", 0, 4,
              "Strength of small relief: 0 for smooth ground, 4 for broken rock");
    return t;
  }();
  return params;
}

enum class Stream : std::uint64_t { outline = 1, joints = 2, top = 3, rock = 4, skew = 5 };

/// Chosen by eye on the default map; metres where nothing else is said.
namespace look {
constexpr double outline_size = 0.35, outline_bends = 0.06;  // of the breadth: the headland's own bends
constexpr double skew = 0.12;                         // of the breadth: most that it stands off the middle
constexpr double joint_size = 14, joint_depth = 2.2;  // notches that joints make in the shore
constexpr double rock_size = 3.5, rock_depth = 0.5;   // blocks of the shore
constexpr double top_size = 45, top_relief = 0.05;    // swells of the plateau, as a share of its height
constexpr double top_tilt = 0.02;                     // rise of the plateau inland, metres per metre
constexpr double foot = -0.5;                         // the face goes on a little below the sea
constexpr double deepening = 25;                      // way in which most of the water's depth is reached
constexpr double cove_edge = 40;                      // way in which the beach begins beside the headland
constexpr double sand_top = 1.5, sand_most = 1.8;     // elevations of the beach at its back
constexpr double beach_slope = 2.5;                   // rise of the sand over its width
constexpr double sand_relief = 0.3, grain = 0.15;     // of the beach; of rock anywhere
}  // namespace look

class Builder {
 public:
  Builder(const Headland& p, std::uint64_t seed)
      : p_(p),
        middle_(0.5 * p.pixel * p.columns()),
        shore_(0.5 * p.pixel * p.rows()),
        outline_(look::outline_size * p.breadth, 3, seed, Stream::outline),
        joints_(look::joint_size, 3, seed, Stream::joints),
        top_(look::top_size, 4, seed, Stream::top),
        rock_(look::rock_size, 2, seed, Stream::rock),
        skew_(look::skew * p.breadth * (Random(seed, Stream::skew).uniform() - 0.5)) {}

  double height(Vec2d p) const {
    const double d = inland(p);
    const double cove = 1 - smoothstep(0.0, look::cove_edge,
                                       0.5 * p_.breadth + look::cove_edge - std::abs(p.x - middle_ - skew_));
    const double plateau =
        p_.elevation * (1 + look::top_relief * p_.roughness * top_.at(p)) + look::top_tilt * std::max(d, 0.0);
    // The face rises bed by bed: each bed stands upright and leaves a ledge.
    double rise = std::clamp(d / p_.cliff, 0.0, 1.0);
    const double beds = std::max(p_.elevation / p_.bed, 1.0);
    const double whole = std::floor(rise * beds), part = rise * beds - whole;
    rise = (whole + smoothstep(0.0, 0.5, part)) / beds;
    const double floor = look::foot - p_.sea_depth * (1 - std::exp(std::min(d, 0.0) / look::deepening));
    const double face = d > 0 ? look::foot + (plateau - look::foot) * rise : floor;
    const double sand = look::sand_top + (d - 2) * look::beach_slope / std::max(p_.beach, 1e-6) +
                        look::sand_relief * p_.roughness * top_.at(p);
    const double beached = cove > 0 && p_.beach > 0
                               ? face + cove * (std::max(face, std::min(sand, look::sand_most)) - face)
                               : face;
    return beached + look::grain * p_.roughness * rock_.at(p);
  }

  raster::Raster run(Progress& progress) const {
    return impl::by_points(p_, "headland", progress, [&](Vec2d p) { return height(p); });
  }

 private:
  /// How far the shore lies south of the map's middle, without its small bends.
  double line(double x) const {
    const double u = (x - middle_ - skew_) / (0.5 * p_.breadth);
    return p_.reach * (std::exp(-u * u * u * u) - 0.5);
  }
  /// About the distance from the shore, positive on land.
  double inland(Vec2d p) const {
    const double plain = (p.y - shore_ + line(p.x)) / std::hypot(1.0, 0.5 * (line(p.x + 1) - line(p.x - 1)));
    const double bends = look::outline_bends * p_.breadth * outline_.at(p) +
                         p_.roughness * (look::joint_depth * joints_.at(p) + look::rock_depth * rock_.at(p));
    return plain + bends * std::exp(-std::abs(plain) / p_.breadth);
  }

  Headland p_;
  double middle_, shore_;
  PlaneNoise outline_, joints_, top_, rock_;
  double skew_;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Headland p;
  assign(table().infos(), &p, values, "headland");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& declaration() {
  static const GeneratorType type{
      .about = {.name = "headland",
                .doc = "A headland of bedded limestone with upright cliffs between two coves",
                .source = "the setting of [Paris19 fig. 25]",
                .params = table()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain::generator_headland
