// Chambers [Ju01 §4]: rooms grown by subdivision from a small lattice of values, at given places or under the
// middle of the site; all are carved into one volume.

#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/landforms/hollows/hollow.h"
#include "tafoni/landforms/hollows/tunnel_planner.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/table_rows.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms::landform_chambers {
namespace {

using impl::Ground;

/// Chosen by eye.
namespace look {
// Samples of a cell of a chamber's lattice.
constexpr double samples_a_cell = 6;
// How high the middle of a chamber's floor lies in it, in cells.
constexpr double floor_height = 0.5;
// The ground over a chamber is asked for its height at so many places to each side of the middle.
constexpr int ground_places = 4;
// Metres: what the unevenness of walls goes by, as it goes by the radius of a tunnel.
constexpr double radius = 2.5;
}  // namespace look

struct Params : impl::HollowParams {
  std::string kind = "queen";
  double cell = 0;
  double noise = 0;
  double cover = 4;
  Rows chamber;
  Params() { roughness = 0.15, relief = 0.3; }
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    std::vector<std::string> kinds;
    std::string what;
    for (const volume::ChamberPreset& preset : volume::chamber_presets()) {
      kinds.push_back(preset.name);
      what += (what.empty() ? "" : "; ") + preset.name + ": " + preset.doc;
    }
    ParamTable<Params> t;
    t.choice("kind", &Params::kind, kinds, what)
        .real("cell", &Params::cell, "m", 0, 100,
              "Side of a cell of the chamber's lattice; 0 for the kind's own")
        .real("noise", &Params::noise, "", 0, 2,
              "Most that subdivision moves its first values, in cells: a little makes rough walls, much a "
              "hell of flying rocks")
        .real("cover", &Params::cover, "m", 0, 1000,
              "Rock over the roof of a chamber whose height is not given");
    impl::add_hollow_params(t);
    t.rows(
        "chamber", &Params::chamber,
        {numbers_column("at", "", "m", 3, -1e9, 1e9,
                        "World x, y and z of the middle of its floor; empty for under the middle of the "
                        "site"),
         choice_column("kind", "", kinds, "Kind; empty for the layer's"),
         numbers_column("turn", "0", "deg", 1, -3600, 3600, "Turn about the vertical, counter-clockwise"),
         numbers_column("cell", "", "m", 1, 0.05, 100, "Side of a cell; empty for the layer's"),
         numbers_column("noise", "", "", 1, 0, 2, "Noise; empty for the layer's"),
         column(
             "lattice", "",
             "Its own values from -1, open, to 1, rock: layers from the lowest up end with ;, rows from the "
             "north with / or a new line; numbers, or words of # + o - . for 1 to -1")},
        "Chambers and where they are; none for one of the layer's kind under the middle of the site");
    return t;
  }();
  return params;
}

volume::Chamber chamber_of(const Ground& ground, const Params& p, const Row& row, std::uint64_t seed,
                           const std::string& where) {
  const std::string_view kind = impl::text_in(row, "kind"), own = impl::text_in(row, "lattice");
  const volume::ChamberPreset& preset = volume::find_chamber_preset(kind.empty() ? p.kind : kind);
  const volume::ChamberLattice lattice = volume::parse_lattice(own.empty() ? preset.lattice : own, where);
  volume::ChamberSettings s;
  s.cell = impl::number_in(row, "cell").value_or(p.cell > 0 ? p.cell : preset.cell);
  s.noise = impl::number_in(row, "noise").value_or(p.noise);
  s.turn = impl::number_in(row, "turn").value_or(0) * degree;
  s.spacing = p.spacing > 0 ? p.spacing : s.cell / look::samples_a_cell;
  s.seed = seed;
  if (!impl::text_in(row, "at").empty()) {
    s.position = impl::point_in(row, "at", where) - ground.site().origin;
    s.position.z -= look::floor_height * s.cell;
    return volume::Chamber(lattice, s);
  }
  const Vec3d middle = ground.box().center();
  const double half = 0.5 * s.cell * std::hypot(lattice.cells.x, lattice.cells.y);
  double low = 1e30;
  constexpr int n = look::ground_places;
  for (int j = -n; j <= n; ++j)
    for (int i = -n; i <= n; ++i)
      low = std::min(low, ground.height(middle.x + i * half / n, middle.y + j * half / n));
  s.position = {middle.x, middle.y, low - p.cover - s.cell * lattice.cells.z};
  return volume::Chamber(lattice, s);
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "chambers");
  progress.check();
  const Ground ground(site);
  const Rows rows = p.chamber.empty() ? Rows{{}} : p.chamber;
  impl::Hollow hollow(ground, p, look::radius);
  std::vector<Vec3d> places;
  std::vector<double> sizes;
  std::uint64_t index = 0;
  for (const Row& row : rows) {
    const volume::Chamber chamber = chamber_of(ground, p, row, hash_combine(site.seed, index),
                                               fmt::format("chambers: chamber, row {}", index + 1));
    ++index;
    if (ground.box().empty() || !ground.box().overlaps(chamber.bounds())) {
      progress.warn(fmt::format(
          "chambers: chamber, row {} is not made: it lies outside the terrain or where the layer may not act",
          index));
      continue;
    }
    const Vec3d size = chamber.size();
    places.push_back(chamber.settings().position + Vec3d{0, 0, look::floor_height * chamber.settings().cell});
    sizes.insert(sizes.end(), {size.x, size.y, size.z});
    hollow.add(chamber);
  }
  Result result = hollow.finish(progress);
  result.facts.places("chambers", places)
      .about("x, y and z of the middle of each chamber in turn")
      .lengths("sizes", sizes)
      .about("Sides along x, y and z of each chamber in turn, before it is turned")
      .count("primitives", 0);
  return result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "chambers",
                .doc = "Underground rooms from few chosen values: storage room, queen's chamber, or one's "
                       "own lattice",
                .source = "[Ju01 §4]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_chambers
