#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/math/noise.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/rows.h"

namespace tafoni::terrain {
namespace {

struct Cliff : GridSettings {
  Cliff() {
    width = 280;
    height = 180;
    pixel = 0.5;
  }
  double elevation = 60;
  double shelf = 2;
  double place = 0.62;
  double slope = 74;
  double bends = 7;
  double roughness = 1;
};

const ParamTable<Cliff>& table() {
  static const ParamTable<Cliff> params = [] {
    ParamTable<Cliff> t;
    add_grid_params(t);
    t.real("elevation", &Cliff::elevation, "m", -1000, 10000, "elevation of the plateau in the west")
        .real("shelf", &Cliff::shelf, "m", -1000, 10000, "elevation of the shelf at the foot, in the east")
        .real("place", &Cliff::place, "", 0, 1,
              "where the middle of the cliff stands, as a share of the width")
        .real("slope", &Cliff::slope, "deg", 5, 85, "steepness of the face")
        .real("bends", &Cliff::bends, "m", 0, 1000, "most that the cliff's line bends forward or back")
        .real("roughness", &Cliff::roughness, "", 0, 5, "strength of small relief");
    return t;
  }();
  return params;
}

double smooth_min(double a, double b, double width) {
  const double t = std::clamp(0.5 + 0.5 * (b - a) / width, 0.0, 1.0);
  return b + (a - b) * t - width * t * (1 - t);
}

/// Plateau, face and shelf joined by round edges.
class Builder {
 public:
  Builder(const Cliff& p, std::uint64_t seed) : p_(p), seed_(seed) {}

  raster::Raster run(Progress& progress) const {
    return impl::by_rows(p_, "cliff", progress, [&](int row, const raster::Placement& at, float* out) {
      for (int col = 0; col < static_cast<int>(p_.width); ++col)
        out[col] = static_cast<float>(height(at.center(col, row)));
    });
  }

 private:
  /// Noise in [-1, 1].
  double noise(Vec2d p, double wavelength, int octaves, std::uint64_t stream) const {
    return 2.0 * static_cast<double>(fbm(Vec3d{p.x / wavelength, p.y / wavelength, 0}, octaves,
                                         hash_combine(seed_, stream))) -
           1;
  }

  double height(Vec2d p) const {
    const double drop = p_.elevation - p_.shelf, size = std::abs(drop) + p_.pixel;
    const double face = p_.place * static_cast<double>(p_.width) * p_.pixel +
                        p_.bends * noise({0, p.y}, 40 + 2 * p_.bends, 3, 1) +
                        0.03 * size * p_.roughness * noise(p, 0.2 * size, 3, 2);
    const double fall = std::tan(p_.slope * std::numbers::pi / 180);
    const double edge = 0.06 * size;
    const double top = p_.elevation + 0.02 * size * p_.roughness * noise(p, 0.6 * size, 4, 3);
    const double foot = p_.shelf + 0.012 * size * p_.roughness * noise(p, 0.3 * size, 4, 4);
    const double ramp = 0.5 * (p_.elevation + p_.shelf) + std::copysign(fall, drop) * (face - p.x);
    return drop > 0 ? -smooth_min(-smooth_min(ramp, top, edge), -foot, edge)
                    : smooth_min(-smooth_min(-ramp, -top, edge), foot, edge);
  }

  Cliff p_;
  std::uint64_t seed_;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Cliff p;
  assign(table().infos(), &p, values, "cliff");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& generator_cliff() {
  static const GeneratorType type{
      .about = {.name = "cliff",
                .doc = "A plateau, one cliff and a shelf: a block to show rock on",
                .source = "[Paris19 fig. 4]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain
