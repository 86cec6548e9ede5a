// A plateau in the west and a shelf in the east, joined by one straight face with round edges; noise bends
// the line of the face and roughens all three.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/math/noise.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/rows.h"

namespace tafoni::terrain::generator_cliff {
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
    t.real("elevation", &Cliff::elevation, "m", -1000, 10000, "Elevation of the plateau in the west")
        .real("shelf", &Cliff::shelf, "m", -1000, 10000,
              "Elevation of the shelf in the east; above the plateau, the face looks west")
        .real("place", &Cliff::place, "", 0, 1,
              "Where the middle of the face stands, as a share of the width from the west")
        .real("slope", &Cliff::slope, "deg", 5, 85, "Steepness of the face, from a ramp to nearly upright")
        .real("bends", &Cliff::bends, "m", 0, 1000,
              "Most that the line of the cliff bends forward or back; 0 for a straight one")
        .real("roughness", &Cliff::roughness, "", 0, 5,
              "Strength of small relief: 0 for smooth ground, 4 for broken rock");
    return t;
  }();
  return params;
}

enum class Stream : std::uint64_t { line = 1, face = 2, plateau = 3, shelf = 4 };

/// Chosen by eye on the default block; shares are of the height of the cliff.
namespace look {
constexpr double bend_length = 40, bend_stretch = 2;      // m from bend to bend: deep bends are long ones too
constexpr double edge = 0.06;                             // rounding of the plateau's rim and of the foot
constexpr double face_relief = 0.03, face_size = 0.2;     // the face is broken in small ribs …
constexpr double top_relief = 0.02, top_size = 0.6;       // … the plateau rolls gently …
constexpr double shelf_relief = 0.012, shelf_size = 0.3;  // … and the shelf, which the sea wore down, least
}  // namespace look

double smooth_min(double a, double b, double width) {
  const double t = std::clamp(0.5 + 0.5 * (b - a) / width, 0.0, 1.0);
  return b + (a - b) * t - width * t * (1 - t);
}

/// Plateau, face and shelf joined by round edges.
class Builder {
 public:
  Builder(const Cliff& p, std::uint64_t seed) : p_(p), seed_(seed) {}

  raster::Raster run(Progress& progress) const {
    return impl::by_points(p_, "cliff", progress, [&](Vec2d p) { return height(p); });
  }

 private:
  /// Noise in [-1, 1].
  double noise(Vec2d p, double wavelength, int octaves, Stream stream) const {
    return 2.0 * fbm(Vec3d{p.x / wavelength, p.y / wavelength, 0}, octaves, hash_combine(seed_, stream)) - 1;
  }

  double height(Vec2d p) const {
    const double drop = p_.elevation - p_.shelf, size = std::abs(drop) + p_.pixel;
    const double face =
        p_.place * p_.columns() * p_.pixel +
        p_.bends * noise({0, p.y}, look::bend_length + look::bend_stretch * p_.bends, 3, Stream::line) +
        look::face_relief * size * p_.roughness * noise(p, look::face_size * size, 3, Stream::face);
    const double fall = std::tan(p_.slope * std::numbers::pi / 180);
    const double edge = look::edge * size;
    const double top = p_.elevation + look::top_relief * size * p_.roughness *
                                          noise(p, look::top_size * size, 4, Stream::plateau);
    const double foot = p_.shelf + look::shelf_relief * size * p_.roughness *
                                       noise(p, look::shelf_size * size, 4, Stream::shelf);
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

const GeneratorType& declaration() {
  static const GeneratorType type{
      .about = {.name = "cliff",
                .doc = "A plateau, one cliff and a shelf: a block to show rock on",
                .source = "[Paris19 fig. 4]",
                .params = table()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain::generator_cliff
