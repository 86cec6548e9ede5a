// Any text as the small languages of landforms' parameters: rules that hoodoos and caves grow by, and
// chambers as layers of signs. The first line names one; the others are rows of a table, their cells parted
// by bars, or the text. What is refused is one error of kind usage, and what is not comes to an end.

#include <algorithm>

#include "fuzz.h"

#include "tafoni/core/parallel.h"
#include "tafoni/grammar/derive.h"
#include "tafoni/landforms/test/site.h"
#include "tafoni/volume/chamber.h"

using namespace tafoni;

namespace {

std::string table_of(const Rows& rows, const std::vector<ParamInfo>& columns) {
  std::string out;
  for (const Row& row : rows) {
    for (const ParamInfo& column : columns)
      out += (row.contains(column.name) ? row.at(column.name) : std::get<std::string>(column.init)) + "|";
    out += "\n";
  }
  return out;
}

Rows rows_of(std::string_view text, const std::vector<ParamInfo>& columns) {
  Rows out;
  while (!text.empty()) {
    std::string_view line = take_until(text, '\n');
    Row row;
    for (const ParamInfo& column : columns) row[column.name] = std::string(take_until(line, '|'));
    out.push_back(std::move(row));
  }
  return out;
}

const ParamInfo& hoodoo_rules() {
  return find_param(landforms::find_landform("hoodoos").about.params, "rule", "fuzz");
}

/// One hoodoo on level ground.
void grow_hoodoo(std::string_view text) {
  static const landforms::test::Coast level = [] {
    landforms::test::Coast coast([](Vec3d p) { return std::clamp(0.5 + 0.02 * p.z, 0.0, 1.0); },
                                 [](double, double) { return 0.0; });
    coast.site.points.push_back({0, 0, 0});
    return coast;
  }();
  const landforms::Result result = landforms::find_landform("hoodoos").generate(
      level.site,
      {{"density", 0.0}, {"axiom", std::string("A")}, {"rule", rows_of(text, hoodoo_rules().columns)}},
      silent());
  const field::CompiledField rock = landforms::test::carved(level.site, result);
  for (const double z : {-2.0, 0.5, 9.0}) require(std::isfinite(rock.value({0.5, 0.25, z})));
}

void grow_cave(std::string_view text) {
  grammar::Settings settings;
  settings.classic = 6;
  grammar::Assembly base;
  grammar::derive_by_rules(base, rows_of(text, grammar::rule_columns()), settings);
  const Box3d box = base.bounds();
  require(base.empty() || (box.bounded() && !box.empty()));
}

void make_chamber(std::string_view text) {
  const volume::ChamberLattice lattice = volume::parse_lattice(text, "fuzz");
  const Vec3i cells = lattice.cells;
  require(cells.x > 0 && cells.y > 0 && cells.z > 0);
  require(lattice.values.size() == std::size_t{1} * (cells.x + 1) * (cells.y + 1) * (cells.z + 1));
  for (const float v : lattice.values) require(v >= -1 && v <= 1);
  if (lattice.values.size() > 100) return;
  volume::ChamberSettings settings;
  settings.spacing = 1.2;
  const volume::Chamber chamber(lattice, settings);
  require(std::isfinite(chamber.value({0.5, 0.5, 0.5})));
}

}  // namespace

std::vector<std::string> fuzz_seeds() {
  set_thread_count(1);
  const auto& rules = std::get<Rows>(hoodoo_rules().init);
  std::vector<std::string> out = {
      "hoodoo\nA|1|Hoodoo(); Goblin(x = 9)|\n" + table_of(rules, hoodoo_rules().columns),
      "hoodoo\nA|1|sphere(radius = s); A(z = s, s = 0.5*s, a = rho(2) ^ 2 - min(h, 3))|\n"
      "A|s < 0.1||\n",
      "cave\nhall|sphere|sum||2|||1|way way|\nway|cube|sum|+X|1..2 1 1|||3|way hall|\n"
      "way|room|sum|-Y|1||0.5|1||\nroom|cone|sum||1|||1|edge|\nedge|torus|difference|+Z|0.5|||1||\n"
      "way|empty|morph|+X|1|60||1|way|\n"};
  for (const volume::ChamberPreset& preset : volume::chamber_presets())
    out.push_back("chamber\n" + preset.lattice);
  out.push_back("chamber\n1 0.5 -1\n.5 -1e-1 1/0 0 0;1 1 1/2 .1 0/0 0 -.5");
  return out;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = as_text(data, size);
  const std::string_view language = take_until(text, '\n');
  accepts(
      [&] {
        if (language == "hoodoo") grow_hoodoo(text);
        if (language == "cave") grow_cave(text);
        if (language == "chamber") make_chamber(text);
      },
      {ErrorKind::usage});
  return 0;
}
