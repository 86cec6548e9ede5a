#include "tafoni/math/noise.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/rows.h"

namespace tafoni::terrain::generator_plane {
namespace {

struct Plane : GridSettings {
  Plane() { width = height = 128; }
  double elevation = 0;
  double roughness = 0.3;
  double wavelength = 30;
};

const ParamTable<Plane>& table() {
  static const ParamTable<Plane> params = [] {
    ParamTable<Plane> t;
    add_grid_params(t);
    t.real("elevation", &Plane::elevation, "m", -10000, 10000, "Elevation about which the ground lies")
        .real("roughness", &Plane::roughness, "m", 0, 1000,
              "Most that the ground rises above its elevation or sinks below it; 0 for a true plane")
        .real("wavelength", &Plane::wavelength, "m", 0.1, 1e5,
              "Distance from rise to rise: small for hummocks, great for gentle swells")
        .only("where roughness is above 0");
    return t;
  }();
  return params;
}

constexpr int octaves = 4;  // detail down to an eighth of the wavelength

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Plane p;
  assign(table().infos(), &p, values, "plane");
  return impl::by_points(p, "plane", progress, [&](Vec2d at) {
    const Vec2d q = at * (1 / p.wavelength);
    return p.elevation + p.roughness * (2.0 * fbm(Vec3d{q.x, q.y, 0}, octaves, seed) - 1);
  });
}

}  // namespace

const GeneratorType& declaration() {
  static const GeneratorType type{
      .about = {.name = "plane",
                .doc = "Level ground: to put volumes and solids on, or in their place",
                .source = "",
                .params = table()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain::generator_plane
