// tafoni generate: an elevation model of a built-in generator, written as a raster.
#include <memory>

#include "command.h"
#include "scene_run.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/io/dem.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::cli::command_generate {
namespace {

struct Generate {
  std::string generator, output;
  std::vector<std::string> set;
  std::optional<std::int64_t> seed;
};

/// "NAME=VALUE" or "GENERATOR.NAME=VALUE".
void set_value(const terrain::GeneratorType& type, Values& values, std::string_view assignment) {
  const std::string where = fmt::format("--set {}", assignment);
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos)
    fail(ErrorKind::usage, "{}: expected NAME=VALUE, as in width=800", where);
  std::string_view name = assignment.substr(0, equals);
  if (name.starts_with(type.about.name + ".")) name.remove_prefix(type.about.name.size() + 1);
  const ParamInfo& info = find_param(type.about.params, name, where);
  values.insert_or_assign(info.name, parse_value(info, assignment.substr(equals + 1), where));
}

int run(const Generate& g, Console& console) {
  if (g.output.empty()) fail(ErrorKind::usage, "generate needs -o FILE.tif, the elevation model to write");
  const std::string extension = std::filesystem::path(g.output).extension().string();
  if (extension != ".tif" && extension != ".tiff")
    fail(ErrorKind::usage, "{}: an elevation model is written as GeoTIFF; end the name in .tif", g.output);
  const terrain::GeneratorType& type = terrain::find_generator(g.generator);
  Values values;
  for (const std::string& assignment : g.set) set_value(type, values, assignment);
  check_output(g.output, {});
  raster::Raster raster = type.generate(values, g.seed.value_or(0), console);
  // Says that coordinates are metres, so that no reader has to guess.
  if (raster.crs.empty())
    raster.crs = R"(LOCAL_CS["Local metres",UNIT["metre",1],AXIS["Easting",EAST],AXIS["Northing",NORTH]])";
  io::write_geotiff(g.output, raster);
  if (console.json())
    console.result(json_text({{"file", g.output},
                              {"generator", type.about.name},
                              {"seed", g.seed.value_or(0)},
                              {"width", raster.width()},
                              {"height", raster.height()},
                              {"pixel_m", raster.placement.dx},
                              {"warnings", console.warnings()}}));
  else
    console.print(fmt::format("{}  {} x {} pixels of {:g} m\n", g.output, raster.width(), raster.height(),
                              raster.placement.dx));
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  auto g = std::make_shared<Generate>();
  args.positional("GENERATOR", g->generator, "Name of a built-in generator; see tafoni list generators");
  args.text("-o,--output", "TIF", g->output, "GeoTIFF to write");
  args.texts("--set", "NAME=VALUE", g->set, "Sets a parameter of the generator; may be repeated");
  args.integer("--seed", "N", g->seed, 0, std::int64_t{1} << 53,
               "Seed that every random choice is made from; default: 0");
  return [g](Console& console) { return run(*g, console); };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "generate", .doc = "Make an elevation model to start from"},
      .examples = "  tafoni generate coast -o coast.tif --seed 3",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_generate
