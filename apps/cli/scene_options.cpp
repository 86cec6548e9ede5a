// What commands that work on a scene have in common: its options, its outputs' options, and its files.
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "scene_run.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/scene/products/volume_scene.h"

namespace tafoni::cli {

namespace fs = std::filesystem;

void SceneOptions::declare(Args& args) {
  args.group("Scene");
  args.texts("--set", "TARGET.NAME=VALUE", set,
             "Set a parameter of a layer, a geology, the terrain or the scene; may be repeated");
  args.text("--dem", "FILE", dem,
            "Elevation model to put the scene on in place of its own; the voxel then follows from it");
  args.numbers("--window", "X,Y,W,H", window, 4, "Part of the elevation model to use, in pixels");
  args.number("--resolution", "M", resolution, 0, 1e5, "m", "Pixel size to bring the elevation model to");
  args.number("--voxel", "M", voxel, 0, 1e5, "m",
              "Size of a lattice cell; default: from pixel size and extent");
  args.choice("--boundary", boundary, {"solid", "open"},
              "Close the mesh with walls and a base, or leave a sheet");
  args.number("--simplify", "M", simplify, 0, 1e4, "m", "Greatest distance a simplified mesh may stray");
  args.integer("--seed", "N", seed, 0, std::int64_t{1} << 53, "What every random choice is made from");
}

void SceneOptions::apply(scene::Document& document) const {
  if (!dem.empty()) {
    const scene::TerrainSection own = document.terrain;
    document.terrain = {};
    document.terrain.source = fs::absolute(dem).string();
    document.terrain.influence = own.influence;
    document.terrain.amplitude = own.amplitude;
    document.terrain.interpolation = own.interpolation;
    document.terrain.distance = own.distance;
    document.scene.voxel = 0;
  }
  if (!window.empty()) document.terrain.window = window;
  if (resolution) document.terrain.resolution = *resolution;
  if (voxel) document.scene.voxel = *voxel;
  if (simplify) document.scene.simplify = *simplify;
  if (seed) document.scene.seed = *seed;
  if (!boundary.empty()) document.scene.boundary = boundary;
  for (const std::string& assignment : set) scene::set(document, assignment);
  scene::check(document, "the scene");
}

void OutputOptions::declare(Args& args) {
  args.group("Output");
  args.texts("-o,--output", "FILE", files,
             "Mesh or volume to write; the extension chooses the format; may be repeated");
  args.text("--preview", "PNG", preview, "Picture to write");
  args.text("--save-scene", "TOML", save_scene, "Scene file to write, which builds the same again");
  args.text("--report", "JSON", report, "Report to write: timings, counts, bounds, warnings");
  args.integer("--tiles", "N", tiles, 1, 1024,
               "Write N x N meshes that meet exactly, as NAME_X_Y; memory for one tile at a time");
  args.number("--band", "M", band, 0, 1e5, "m",
              "Greatest magnitude of a volume's values, so that only what is near the surface takes space; 0 "
              "keeps all; default: four cells");
  args.number("--texture", "M", texture, 1e-3, 1e6, "m",
              "Give OBJ and GLB files texture coordinates, projected from the sides of a box; a picture "
              "covers M metres");
  args.flag("--half", half, "Write volumes in half precision");
  args.flag("--dry-run", dry_run, "Predict triangles, memory and bytes instead of writing");
}

bool is_mesh_file(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (extension.empty()) return false;
  extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const io::FormatType* format : io::all_formats())
    if (format->read_mesh && std::find(format->extensions.begin(), format->extensions.end(), extension) !=
                                 format->extensions.end())
      return true;
  return false;
}

bool is_scene_file(const std::string& path) {
  return fs::path(path).extension() == ".toml";
}

scene::Document open_document(const std::string& path) {
  if (is_scene_file(path)) return scene::load_scene(path);
  if (io::can(path, io::Ability::read_volume)) return scene::volume_document(path);
  scene::Document document;
  document.terrain.source = path;
  return document;
}

std::vector<fs::path> inputs_of(const scene::Document& document) {
  std::vector<fs::path> out;
  const auto add = [&](const std::string& path) {
    if (!path.empty()) out.push_back(document.resolve(path));
  };
  add(document.terrain.source);
  add(document.terrain.domain);
  for (const scene::Layer& layer : document.layers)
    for (const std::string& path : scene::paths_of(layer)) add(path);
  return out;
}

void check_output(const fs::path& path, const std::vector<fs::path>& inputs) {
  std::error_code code;
  for (const fs::path& input : inputs) {
    if (fs::equivalent(path, input, code))
      fail(ErrorKind::usage, "{}: is an input of this command and would be overwritten; choose another name",
           path.string());
  }
  const AtomicFile probe(path);
}

void write_file(const fs::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace tafoni::cli
