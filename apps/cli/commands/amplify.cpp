// tafoni amplify: a scene made on the command line, of an elevation model and layers by name.
#include <memory>

#include "command.h"
#include "scene_run.h"

#include "tafoni/core/error.h"
#include "tafoni/geology/kind.h"

namespace tafoni::cli::command_amplify {
namespace {

struct Amplify {
  std::string dem, region, points;
  std::vector<std::string> layers, geology;
  SceneOptions scene;
  OutputOptions outputs;
};

scene::Document document_of(const Amplify& a) {
  if (is_scene_file(a.dem))
    fail(ErrorKind::usage, "{}: is a scene; use tafoni build for scenes, amplify for elevation models",
         a.dem);
  if (a.layers.empty() && !(a.region.empty() && a.points.empty()))
    fail(ErrorKind::usage, "--region and --points are for layers; give -l LANDFORM");
  scene::Document document = open_document(a.dem);
  for (const std::string& type : a.geology) {
    document.geology.push_back({type, {}, 0});
    // What changes other rock changes the default one.
    document.geology.back().of.resize(geology::find_geology(type).min_children, {"strata", {}, 0});
  }
  for (const std::string& type : a.layers) {
    scene::params_of_layer(type);
    scene::Layer layer;
    layer.type = type;
    layer.settings.region = a.region;
    layer.settings.points = a.points;
    document.layers.push_back(std::move(layer));
  }
  a.scene.apply(document);
  return document;
}

std::function<int(Console&)> setup(Args& args) {
  auto a = std::make_shared<Amplify>();
  args.positional("DEM", a->dem, "Path of an elevation model, anything that GDAL reads");
  args.group("Layers");
  args.texts("-l,--layer", "LANDFORM", a->layers,
             "Landform to add as a layer; may be repeated, and layers act in the order given");
  args.text("--region", "FILE", a->region,
            "Path of a polygon file (GeoJSON …), inside of which alone the layers act; default: they act "
            "everywhere");
  args.text("--points", "CSV", a->points,
            "Path of a CSV (x,y,z) of places in the elevation model's CRS that the landforms start from; "
            "default: they choose");
  args.texts("--geology", "KIND", a->geology,
             "Kind of rock; may be repeated, and several are blended; one that changes other rock changes "
             "strata; default: strata");
  a->scene.declare(args);
  a->outputs.declare(args);
  return [a](Console& console) {
    run_scene(document_of(*a), {}, a->outputs, console);
    return 0;
  };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "amplify", .doc = "Turn an elevation model into a 3D terrain mesh"},
      .examples =
          "  tafoni amplify coast.tif -l sea-cliff -l karst -o coast.glb --preview coast.png\n"
          "  tafoni amplify dem.tif -l karst --set karst.radius=4 --window 100,100,512,512 -o part.ply",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_amplify
