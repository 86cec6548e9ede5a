#include "tafoni/math/noise.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/rows.h"

namespace tafoni::terrain {
namespace {

struct Plane : GridSettings {
  Plane() {
    width = 128;
    height = 128;
  }
  double elevation = 0;
  double roughness = 0.3;
  double wavelength = 30;
};

const ParamTable<Plane>& table() {
  static const ParamTable<Plane> params = [] {
    ParamTable<Plane> t;
    add_grid_params(t);
    t.real("elevation", &Plane::elevation, "m", -10000, 10000, "its height")
        .real("roughness", &Plane::roughness, "m", 0, 1000, "most that it rises or falls; 0 for a true plane")
        .real("wavelength", &Plane::wavelength, "m", 0.1, 1e5, "breadth of what rises and falls");
    return t;
  }();
  return params;
}

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Plane p;
  assign(table().infos(), &p, values, "plane");
  return impl::by_rows(p, "plane", progress, [&](int row, const raster::Placement& at, float* out) {
    for (int col = 0; col < static_cast<int>(p.width); ++col) {
      const Vec2d q = at.center(col, row) * (1 / p.wavelength);
      const double t = static_cast<double>(fbm(Vec3d{q.x, q.y, 0}, 4, seed));
      out[col] = static_cast<float>(p.elevation + p.roughness * (2 * t - 1));
    }
  });
}

}  // namespace

const GeneratorType& generator_plane() {
  static const GeneratorType type{
      .about = {.name = "plane",
                .doc = "Level ground: to put volumes and solids on, or in their place",
                .source = "",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain
