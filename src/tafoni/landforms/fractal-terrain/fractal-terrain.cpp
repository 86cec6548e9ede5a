#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/fractal_ground.h"
#include "tafoni/landforms/site/cells.h"

namespace tafoni::landforms {
namespace {

using impl::Ground;

struct Params {
  double noise = 0.6;
  double decay = 0.5;
  double coarse = 0;
  double spacing = 0;
  std::int64_t smooth = 2;
  bool detail = true;
  double fade = 0;
  Rows pin;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("noise", &Params::noise, "", 0, 5,
           "scale of the noise: 0.2 makes hills, 0.5 crags and overhangs, 1 caves and bridges, 2 closets and "
           "loose rock; 0 for the terrain as it is")
        .real("decay", &Params::decay, "", 0.1, 1,
              "what is left of the noise from one level to the next: 0.5 for crags of every size, less for "
              "smoother rock")
        .real("coarse", &Params::coarse, "m", 0, 1e5,
              "between the given values of the first level, the size of the largest forms; 0 for a quarter "
              "of the "
              "shorter side")
        .real("spacing", &Params::spacing, "m", 0, 1000,
              "most between samples of the last level, 0 for the site's own: a 400th of its longer side or a "
              "quarter of a pixel")
        .integer("smooth", &Params::smooth, "", 0, 12, "last levels without noise, which round off edges")
        .boolean(
            "detail", &Params::detail,
            "whether the terrain keeps its own detail under the noise; else only its coarse shape is given")
        .real("fade", &Params::fade, "m", 0, 1e5,
              "inside the region's border over which the volume takes over, 0 for a quarter of coarse")
        .rows("pin", &Params::pin,
              {numbers_column("x", "", "m", 1, -1e9, 1e9, "world"),
               numbers_column("y", "", "m", 1, -1e9, 1e9, "world"),
               numbers_column("z", "", "m", 1, -1e5, 1e5, "elevation; empty for the terrain's"),
               numbers_column("value", "0", "m", 1, -1e5, 1e5,
                              "rock over the surface there, negative for open space"),
               numbers_column("radius", "20", "m", 1, 0, 1e5, "over which its draw falls off")},
              "places whose value is given: mountains, hollows, entrances");
    return t;
  }();
  return params;
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "fractal-terrain");
  const Ground ground(site);
  impl::FractalGroundSettings s;
  s.noise = p.noise;
  s.decay = p.decay;
  s.coarse = p.coarse;
  s.spacing = p.spacing;
  s.smooth = static_cast<int>(p.smooth);
  s.detail = p.detail;
  s.fade = p.fade;
  s.seed = site.seed;
  for (const Row& row : p.pin) {
    const std::string where = fmt::format("fractal-terrain: pin, row {}", s.pins.size() + 1);
    volume::Pin pin;
    pin.position.x = impl::required_number_in(row, "x", where) - site.origin.x;
    pin.position.y = impl::required_number_in(row, "y", where) - site.origin.y;
    const auto z = impl::number_in(row, "z");
    pin.position.z = z ? *z - site.origin.z : ground.height(pin.position.x, pin.position.y);
    pin.value = impl::required_number_in(row, "value", where);
    pin.radius = impl::required_number_in(row, "radius", where);
    s.pins.push_back(pin);
  }
  return impl::fractal_ground(ground, s, progress).result;
}

}  // namespace

const LandformType& landform_fractal_terrain() {
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

}  // namespace tafoni::landforms
