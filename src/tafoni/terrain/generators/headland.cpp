// A headland of bedded limestone between two coves: a level plateau that ends in upright cliffs over shallow
// water.

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/rows.h"

namespace tafoni::terrain {
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
    t.real("elevation", &Headland::elevation, "m", 1, 1000, "height of the plateau above the sea")
        .real("reach", &Headland::reach, "m", 0, 5000, "how far the headland reaches beyond the coves")
        .real("breadth", &Headland::breadth, "m", 5, 20000, "breadth of the headland")
        .real("cliff", &Headland::cliff, "m", 0.5, 500, "width of the cliffs on the map")
        .real("bed", &Headland::bed, "m", 0.2, 200, "thickness of the beds, which step the cliffs")
        .real("sea_depth", &Headland::sea_depth, "m", 0, 500, "depth of the water some way off the cliffs")
        .real("beach", &Headland::beach, "m", 0, 500, "width of the beaches in the coves")
        .real("roughness", &Headland::roughness, "", 0, 4, "strength of small relief");
    return t;
  }();
  return params;
}

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

class Builder {
 public:
  Builder(const Headland& p, std::uint64_t seed)
      : p_(p),
        middle_(0.5 * p.pixel * static_cast<double>(p.width)),
        shore_(0.5 * p.pixel * static_cast<double>(p.height)),
        outline_(0.35 * p.breadth, 3, hash_combine(seed, 1)),
        joints_(14, 3, hash_combine(seed, 2)),
        top_(45, 4, hash_combine(seed, 3)),
        rock_(3.5, 2, hash_combine(seed, 4)),
        skew_(0.12 * p.breadth * (Random(seed, 5).uniform() - 0.5)) {}

  double height(Vec2d p) const {
    const double d = inland(p);
    const double cove = 1 - smooth((0.5 * p_.breadth + 40 - std::abs(p.x - middle_ - skew_)) / 40);
    const double plateau = p_.elevation * (1 + 0.05 * p_.roughness * top_.at(p)) + 0.02 * std::max(d, 0.0);
    // The face rises bed by bed: each bed stands upright and leaves a ledge.
    double rise = std::clamp(d / p_.cliff, 0.0, 1.0);
    const double beds = std::max(p_.elevation / p_.bed, 1.0);
    const double whole = std::floor(rise * beds), part = rise * beds - whole;
    rise = (whole + smooth(2 * part)) / beds;
    const double foot = -0.5;
    const double floor = foot - p_.sea_depth * (1 - std::exp(std::min(d, 0.0) / 25));
    const double face = d > 0 ? foot + (plateau - foot) * rise : floor;
    const double sand = 1.5 + (d - 2) * 2.5 / std::max(p_.beach, 1e-6) + 0.3 * p_.roughness * top_.at(p);
    const double beached =
        cove > 0 && p_.beach > 0 ? face + cove * (std::max(face, std::min(sand, 1.8)) - face) : face;
    return beached + 0.15 * p_.roughness * rock_.at(p);
  }

  raster::Raster run(Progress& progress) const {
    return impl::by_rows(p_, "headland", progress, [&](int row, const raster::Placement& at, float* out) {
      for (int col = 0; col < static_cast<int>(p_.width); ++col)
        out[col] = static_cast<float>(height(at.center(col, row)));
    });
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
    const double bends =
        0.06 * p_.breadth * outline_.at(p) + p_.roughness * (2.2 * joints_.at(p) + 0.5 * rock_.at(p));
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

const GeneratorType& generator_headland() {
  static const GeneratorType type{
      .about = {.name = "headland",
                .doc = "A headland of bedded limestone with upright cliffs between two coves",
                .source = "the setting of [Paris19 fig. 25]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain
