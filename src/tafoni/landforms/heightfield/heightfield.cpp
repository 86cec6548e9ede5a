// A second elevation model in the scene: its rock, or the rock above it, is added, cut out, or what lies
// outside is cut off, within an upright prism over where the layer may act.

#include <algorithm>
#include <cmath>

#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/math/counts.h"
#include "tafoni/raster/distance.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::landforms::landform_heightfield {
namespace {

using impl::Ground;

// Chosen by eye, in influences of the terrain.
constexpr double default_thickness = 4;  // of rock above an inverted surface
constexpr double below = 4;              // the prism's sole under the lowest ground: what is cut is real rock
constexpr double tall = 1e5;             // metres up and down that values may change: all there is

struct Params {
  std::string generator = "plateau";
  std::string operation = "union";
  bool inverted = false;
  double elevation = 0;
  double scale = 1;
  double thickness = 0;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.text("generator", &Params::generator, "Which built-in elevation model; see `tafoni list generators`")
        .choice("operation", &Params::operation, {"union", "intersection", "difference"},
                "Whether its rock is added (union), what lies outside of it is cut off (intersection), or it "
                "is cut out "
                "(difference)")
        .boolean("inverted", &Params::inverted, "Whether its rock lies above its surface instead of below")
        .real("elevation", &Params::elevation, "m", -12000, 10000,
              "Height of its mean level above the terrain's; negative below it")
        .real("scale", &Params::scale, "", -100, 100,
              "Factor on its heights about the mean; negative makes hills of hollows")
        .real("thickness", &Params::thickness, "m", 0, 10000,
              "Thickness of the rock that is added by an inverted one, 0 for four times the terrain's "
              "influence")
        .only("where inverted is true and operation is union", {{"inverted", true}});
    return t;
  }();
  return params;
}

/// Signed distance to where the layer may act, on real data; positive inside, zero R within the border, so
/// that the field is the old one beyond it (the Minkowski difference of [Paris19 §5.1]).
std::shared_ptr<const raster::Raster> outline(const Site& site, const Ground& ground, Progress& progress) {
  auto made = std::make_shared<raster::Raster>(*site.heights);
  raster::Grid<std::uint8_t> mask(made->width(), made->height(), 0);
  for (int row = 1; row + 1 < mask.height(); ++row)
    for (int col = 1; col + 1 < mask.width(); ++col) {
      const Vec2d at = made->placement.center(col, row);
      Vec3d p{at.x, at.y, ground.box().center().z};
      mask.at(col, row) = ground.usable(p);
    }
  made->values = raster::signed_distance(mask, made->placement.dx, made->placement.dy, progress);
  const auto inset = static_cast<float>(site.influence);
  bool any = false;
  for (float& v : made->values.values()) {
    v = std::clamp(v, -1e6f, 1e6f) - inset;
    any |= v > 0;
  }
  return any ? made : nullptr;
}

/// The other elevation model over the same ground, at the same pixel.
std::shared_ptr<const raster::Raster> second_model(const Site& site, const Params& p, Progress& progress) {
  const raster::Raster& own = *site.heights;
  raster::Raster made = terrain::find_generator(p.generator)
                            .generate({{"width", std::int64_t{own.width()}},
                                       {"height", std::int64_t{own.height()}},
                                       {"pixel", own.placement.dx}},
                                      site.seed, progress);
  const double middle = mean(made.values.values()), level = mean(own.values.values()) + p.elevation;
  for (float& h : made.values.values()) h = static_cast<float>(level + p.scale * (h - middle));
  made.placement = own.placement;
  return std::make_shared<raster::Raster>(std::move(made));
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "heightfield");
  terrain::find_generator(p.generator);
  progress.check();
  const Ground ground(site);
  Result result;
  const auto inside = ground.box().empty() ? nullptr : outline(site, ground, progress);
  if (!inside) {
    result.facts.area("area", 0).about("Area that the second elevation model covers").count("primitives", 0);
    return result;
  }
  const auto heights = second_model(site, p, progress);
  field::HeightfieldSettings settings;
  settings.influence = site.influence;
  settings.amplitude = site.amplitude;
  const auto low = std::min_element(heights->values.values().begin(), heights->values.values().end());
  const double thickness = p.thickness > 0 ? p.thickness : default_thickness * site.influence;
  Box3d box = ground.box();
  box.lo.z = std::min(box.lo.z, double{*low}) - below * site.influence;
  // "Cut off what is outside" takes away the rock on the other side of the surface.
  const bool above = p.inverted != (p.operation == "intersection");
  field::NodePtr rock = field::heightfield(heights, settings);
  if (above) {
    field::NodePtr top = field::constant(static_cast<float>(site.amplitude));
    if (p.operation == "union") {
      auto lid = std::make_shared<raster::Raster>(*heights);
      for (float& h : lid->values.values()) h += static_cast<float>(thickness);
      top = field::heightfield(std::move(lid), settings);
    }
    rock = field::subtract(std::move(top), std::move(rock));
  }
  field::Domain prism{box, inside};
  rock = field::intersect({std::move(rock), field::domain(prism, settings)});
  double area = 0;
  for (float v : inside->values.values()) area += v > 0;
  result.facts.area("area", area * heights->placement.dx * heights->placement.dy)
      .about("Area that the second elevation model covers")
      .count("primitives", 0);
  result.reshaped = box;
  result.reshaped.hi.z = tall;
  result.reshaped.lo.z = -tall;
  result.reshape = [rock, op = p.operation](field::NodePtr tree) {
    return field::combine(op == "union" ? "union" : "difference", {std::move(tree), rock});
  };
  return result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about =
          {.name = "heightfield",
           .doc =
               "Another elevation model in the same scene, upright or inverted, within the region's outline",
           .source = "[Paris19 §2, §5.1]",
           .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_heightfield
