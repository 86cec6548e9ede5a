#include <memory>

#include "command.h"
#include "scene_run.h"

namespace tafoni::cli::command_build {
namespace {

std::function<int(Console&)> setup(Args& args) {
  struct Build {
    std::string scene_file;
    SceneOptions scene;
    OutputOptions outputs;
  };
  auto b = std::make_shared<Build>();
  args.positional("SCENE", b->scene_file, "Path of a scene file (.toml), an elevation model or a volume");
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

const Command& declaration() {
  static const Command command{
      .about = {.name = "build",
                .doc = "Build a scene file, an elevation model or a volume into meshes and volumes"},
      .examples =
          "  tafoni build scene.toml -o terrain.glb --report report.json\n"
          "  tafoni build scene.toml -o cave.vdb -o cave.glb\n"
          "  tafoni build cave.vdb -o cave.glb\n"
          "  tafoni build scene.toml --voxel 2 --dry-run",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_build
