// Faces that bulge out over their feet: space is warped sideways by noise that changes with height, under a
// control that is 1 on steep ground and fades around it, so that level ground stays as it is.

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/landforms/site/steepest_slope.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms::landform_overhang {
namespace {

// Chosen by eye.
constexpr double least_bulge = 20, bulge_in_pixels = 4;  // metres: smaller ones the raster does not show
constexpr double lateral_share = 3;                      // length of a bulge over its height
constexpr double amplitude_share = 0.4;                  // of the height: more would tear a face into pieces
constexpr double steep_from = 0.7;                       // of the slope: from here ground begins to move
constexpr int widest = 64;                               // pixels that the control is grown by

struct Params {
  double amplitude = 0;
  double vertical = 0;
  double lateral = 0;
  double lift = 0.15;
  double slope = 45;
  std::int64_t octaves = 2;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("amplitude", &Params::amplitude, "m", 0, 1000,
           "Most that a face moves sideways, 0 for two fifths of the vertical wavelength")
        .real("vertical", &Params::vertical, "m", 0, 5000,
              "Height from one bulge to the next, 0 for four pixels of the terrain but 20 m at least")
        .real("lateral", &Params::lateral, "m", 0, 5000,
              "Length of a bulge along the face, 0 for three times the height; under twice the "
              "amplitude pieces may come off")
        .real("lift", &Params::lift, "", 0, 1,
              "Movement up and down, as a share of the amplitude; more makes noses and hoods")
        .real("slope", &Params::slope, "deg", 10, 89, "Slope from which ground is a face and moves fully")
        .integer("octaves", &Params::octaves, "", 1, 6,
                 "Levels of detail of the movement, 1 for smooth bulges");
    return t;
  }();
  return params;
}

using Grid = raster::Grid<float>;

/// The greatest (or the mean) value within `radius` pixels along each axis in turn.
Grid spread(const Grid& in, int radius, bool mean) {
  Grid across(in.width(), in.height()), out(in.width(), in.height());
  const auto pass = [&](const Grid& from, Grid& to, int dc, int dr) {
    for (int row = 0; row < in.height(); ++row)
      for (int col = 0; col < in.width(); ++col) {
        float most = 0, sum = 0;
        for (int k = -radius; k <= radius; ++k) {
          const float v = from.at(std::clamp(col + k * dc, 0, in.width() - 1),
                                  std::clamp(row + k * dr, 0, in.height() - 1));
          most = std::max(most, v);
          sum += v;
        }
        to.at(col, row) = mean ? sum / static_cast<float>(2 * radius + 1) : most;
      }
  };
  pass(in, across, 1, 0);
  pass(across, out, 0, 1);
  return out;
}

/// 1 on faces and for `reach` metres around, fading to 0 over as much again; 0 at missing data.
std::shared_ptr<const raster::Raster> faces(const Site& site, double slope, double reach,
                                            Progress& progress) {
  auto mask = std::make_shared<raster::Raster>(*site.heights);
  const Grid steepness = terrain::slope(*site.heights, progress);
  const double full = std::tan(slope * degree), none = std::tan(steep_from * slope * degree);
  const int radius = std::clamp(round_to(reach / site.heights->placement.dx), 1, widest);
  for (std::size_t i = 0; i < steepness.size(); ++i)
    mask->values.values()[i] = static_cast<float>(smoothstep(none, full, double{steepness.values()[i]}));
  mask->values = spread(spread(mask->values, radius + 1, false), radius, true);
  progress.check();
  if (!site.valid) return mask;
  // Nothing moves across the border of the data, on either side of it.
  Grid missing(mask->width(), mask->height());
  for (std::size_t i = 0; i < missing.size(); ++i) missing.values()[i] = site.valid->values()[i] ? 0.f : 1.f;
  missing = spread(spread(missing, radius + 1, false), radius, true);
  for (std::size_t i = 0; i < missing.size(); ++i) mask->values.values()[i] *= 1 - missing.values()[i];
  return mask;
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "overhang");
  const impl::Ground ground(site);
  field::WarpSettings warp;
  warp.vertical = p.vertical > 0 ? p.vertical : std::max(least_bulge, bulge_in_pixels * ground.pixel());
  warp.lateral = p.lateral > 0 ? p.lateral : lateral_share * warp.vertical;
  const double amplitude = p.amplitude > 0 ? p.amplitude : amplitude_share * warp.vertical;
  warp.amplitude = {amplitude, amplitude, p.lift * amplitude};
  warp.octaves = static_cast<int>(p.octaves);
  warp.seed = site.seed;

  Result result;
  progress.check();
  const auto mask = faces(site, p.slope, amplitude, progress);
  double area = 0;
  if (!ground.box().empty())
    for (int row = 0; row < mask->height(); ++row)
      for (int col = 0; col < mask->width(); ++col) {
        const Vec2d at = mask->placement.center(col, row);
        const double z = site.heights->values.at(col, row);
        if (ground.usable({at.x, at.y, z})) area += mask->values.at(col, row);
      }
  area *= mask->placement.dx * mask->placement.dy;
  result.facts.area("area", area)
      .about("Area of the ground that was displaced, as seen from above")
      .length("amplitude", amplitude)
      .about("How far rock was displaced at most")
      .count("primitives", 0);
  if (area <= 0) return result;
  Region region = site.region ? *site.region : Region();
  region.limit_mask(mask);
  const field::FunctionPtr control = as_function(&region, amplitude);
  // The distance of a heightfield reaches farther up over faces, by the slope.
  const double reach = site.influence * std::hypot(1.0, impl::steepest_slope(*site.heights)) + amplitude;
  result.reshaped = ground.box();
  result.reshaped.lo.z -= reach;
  result.reshaped.hi.z += reach;
  result.reshape = [control, warp](field::NodePtr tree) {
    return field::warp(std::move(tree), control, warp);
  };
  return result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about =
          {.name = "overhang",
           .doc =
               "Faces that bulge and lean out over their feet, by moving space sideways at changing heights",
           .source = "[Paris19 §5.3], after [Gamito01]",
           .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_overhang
