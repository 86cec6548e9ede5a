#include <memory>

#include "command.h"
#include "scene_run.h"

namespace tafoni::cli {
namespace {

std::function<int(Console&)> setup(Args& args) {
  struct Build {
    std::string scene_file;
    SceneOptions scene;
    OutputOptions outputs;
  };
  auto b = std::make_shared<Build>();
  args.positional("SCENE", b->scene_file, "Scene file (.toml), or an elevation model");
  b->scene.declare(args);
  b->outputs.declare(args);
  return [b](Console& console) {
    scene::Document document = open_document(b->scene_file);
    b->scene.apply(document);
    run_scene(document, is_scene_file(b->scene_file) ? b->scene_file : "", b->outputs, console);
    return 0;
  };
}

}  // namespace

const Command& command_build() {
  static const Command command = {"build", "Build a scene file into a mesh",
                                  "  tafoni build scene.toml -o terrain.glb --report report.json\n"
                                  "  tafoni build scene.toml --voxel 2 --dry-run",
                                  setup};
  return command;
}

}  // namespace tafoni::cli
