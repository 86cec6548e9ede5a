// The whole terrain, or a region of it, as a volume by 3D midpoint subdivision [Ju01 §2]. Here are its
// parameters and the pins that the user gives; rock/fractal_ground makes the volume.

#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/fractal_ground.h"
#include "tafoni/landforms/site/table_rows.h"

namespace tafoni::landforms::landform_fractal_terrain {
namespace {

using impl::Ground;

struct Params : impl::FractalGroundSettings {
  Rows pin;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("noise", &Params::noise, "", 0, 5,
           "Scale of the noise: 0.2 makes hills, 0.5 crags and overhangs, 1 caves and bridges, 2 closets and "
           "loose rock; 0 for the terrain as it is")
        .real("decay", &Params::decay, "", 0.1, 1,
              "What is left of the noise from one level to the next: 0.5 for crags of every size, less for "
              "smoother rock")
        .real("coarse", &Params::coarse, "m", 0, 1e5,
              "Distance between the given values of the first level, the size of the largest forms; 0 for a "
              "quarter of the shorter side")
        .real("spacing", &Params::spacing, "m", 0, 1000,
              "Most between samples of the last level; 0 for the site's own: a 400th of its longer side or a "
              "quarter of a pixel")
        .integer("smooth", &Params::smooth, "", 0, 12,
                 "How many last levels have no noise, which rounds off edges")
        .boolean(
            "detail", &Params::detail,
            "Whether the terrain keeps its own detail under the noise; else only its coarse shape is given")
        .real("fade", &Params::fade, "m", 0, 1e5,
              "Width inside the region's border over which the volume takes over; 0 for a quarter of coarse")
        .rows("pin", &Params::pin,
              {numbers_column("x", "", "m", 1, -1e9, 1e9, "World x"),
               numbers_column("y", "", "m", 1, -1e9, 1e9, "World y"),
               numbers_column("z", "", "m", 1, -1e5, 1e5, "Elevation; empty for the terrain's"),
               numbers_column("value", "0", "m", 1, -1e5, 1e5,
                              "Rock over the surface there; negative for open space"),
               numbers_column("radius", "20", "m", 1, 0, 1e5, "Distance over which its draw falls off")},
              "Places whose value is given: mountains, hollows, entrances");
    return t;
  }();
  return params;
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "fractal-terrain");
  const Ground ground(site);
  p.seed = site.seed;
  for (const Row& row : p.pin) {
    const std::string where = fmt::format("fractal-terrain: pin, row {}", p.pins.size() + 1);
    volume::Pin pin;
    pin.position.x = impl::required_number_in(row, "x", where) - site.origin.x;
    pin.position.y = impl::required_number_in(row, "y", where) - site.origin.y;
    const auto z = impl::number_in(row, "z");
    pin.position.z = z ? *z - site.origin.z : ground.height(pin.position.x, pin.position.y);
    pin.value = impl::required_number_in(row, "value", where);
    pin.radius = impl::required_number_in(row, "radius", where);
    p.pins.push_back(pin);
  }
  return impl::fractal_ground(ground, p, progress).result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "fractal-terrain",
                .doc = "The terrain as a volume by 3D midpoint subdivision: crags, caves, bridges "
                       "and closets by the scale of its "
                       "noise",
                .source = "[Ju01 §2]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_fractal_terrain
