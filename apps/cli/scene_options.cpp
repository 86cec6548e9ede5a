// What commands that work on a scene have in common: its options, its outputs' options, and its files.
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "scene_run.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/source_name.h"

namespace tafoni::cli {

namespace fs = std::filesystem;

void SceneOptions::declare(Args& args) {
  args.group("Scene");
  args.texts(
      "--set", "TARGET.NAME=VALUE", set,
      "Sets a parameter of a layer, a geology, the terrain or the scene, as in karst.radius=4; a list is "
      "written NAME=1,2,3; may be repeated");
  args.text(
      "--dem", "FILE", dem,
      "Path of an elevation model to put the scene on in place of its own; the voxel then follows from it");
  args.numbers("--window", "X,Y,W,H", window, 4,
               "Column, row, width and height of the part of the elevation model to use, in pixels; default: "
               "all of it");
  args.number("--resolution", "M", resolution, 1e-4, 1e5, "m",
              "Pixel size to bring the elevation model to; default: its own");
  args.number("--voxel", "M", voxel, 1e-4, 1e5, "m",
              "Size of a cell of the lattice: smaller shows more detail and takes more time and memory; "
              "default: what the scene says, else chosen from the terrain's pixel size and extent");
  args.choice("--boundary", boundary, {"solid", "open"},
              "How the mesh ends: solid closes it with walls and a base, open leaves a sheet; default: what "
              "the scene says, else solid");
  args.number("--simplify", "M", simplify, 0, 1e4, "m",
              "How far a simplified mesh may stray: more leaves fewer triangles; 0 keeps every triangle; "
              "default: what the scene says, else 0");
  args.integer("--seed", "N", seed, 0, std::int64_t{1} << 53,
               "Seed that every random choice is made from; default: the scene's own");
}

void SceneOptions::apply(scene::Document& document) const {
  if (!dem.empty()) {
    const scene::TerrainSection own = document.terrain;
    document.terrain = {};
    scene::Document here;
    here.directory = fs::current_path();
    document.terrain.source = here.resolve(dem).string();
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
  try {
    scene::check(document);
  } catch (const Error& error) {
    // What a file says was checked when it was read.
    fail(ErrorKind::usage, "{}", error.what());
  }
}

std::vector<const char*> SceneOptions::given() const {
  std::vector<const char*> out;
  for (const auto& [name, is_given] :
       std::initializer_list<std::pair<const char*, bool>>{{"--set", !set.empty()},
                                                           {"--dem", !dem.empty()},
                                                           {"--window", !window.empty()},
                                                           {"--resolution", resolution.has_value()},
                                                           {"--voxel", voxel.has_value()},
                                                           {"--simplify", simplify.has_value()},
                                                           {"--boundary", !boundary.empty()},
                                                           {"--seed", seed.has_value()}})
    if (is_given) out.push_back(name);
  return out;
}

void SceneOptions::check_unused(const std::string& file, bool seed_counts) const {
  for (const char* name : given())
    if (!seed_counts || std::string_view(name) != "--seed")
      fail(ErrorKind::usage, "{}: a mesh is as it is; {} is for scenes, elevation models and volumes", file,
           name);
}

void SceneOptions::check_none(const std::string& reason) const {
  for (const char* name : given()) fail(ErrorKind::usage, "{}: {}", name, reason);
}

void OutputOptions::declare(Args& args) {
  args.group("Output");
  args.texts("-o,--output", "FILE", files,
             "Mesh or volume to write, in the format of its extension; may be repeated");
  args.text("--preview", "PICTURE", preview, "Picture of the mesh to write, PNG or JPG");
  args.text("--save-scene", "TOML", save_scene,
            "Scene file to write, which builds the same again, options included");
  args.text("--report", "JSON", report,
            "Report to write: what each layer made, counts, bounds, times and warnings");
  args.integer("--tiles", "N", tiles, 1, 1024,
               "Writes N x N meshes that meet exactly, as NAME_X_Y, and needs memory for one at a time; "
               "default: 1, a whole");
  args.number("--band", "M", band, 0, 1e5, "m",
              "Greatest magnitude of a volume's values: less takes less space, for it keeps only what is "
              "near the surface; 0 keeps all of a field's; default: four cells");
  args.choice("--values", values, {"distance", "field"},
              "What volumes hold: distance, metres to the surface within the band, or field, the values that "
              "the scene is made of; default: distance in .vdb, field in .tvol");
  args.number("--texture", "M", texture, 1e-3, 1e6, "m",
              "Gives OBJ and GLB files texture coordinates, projected from the sides of a box, of pictures "
              "that cover M metres; default: none");
  args.choice(
      "--up", up, {"y", "z"},
      "Axis that points up in OBJ, PLY and STL files; default: y in OBJ, as most programs expect there, z "
      "in the others; GLB has y up always");
  args.flag(
      "--world-coordinates", world_coordinates,
      "Writes positions in PLY and OBJ files as doubles in the CRS, for GIS; default: floats about a local "
      "origin, which stands in the file");
  args.flag(
      "--float-colors", float_colors,
      "Writes colours in GLB files as floats, in three times the space, for programs that misread bytes, "
      "such as Godot 3; default: bytes");
  args.flag("--half", half, "Writes volumes in half precision, in half the space; default: single precision");
  args.flag("--force", force, "Builds also what seems to take more memory or disk than there is");
  args.flag("--dry-run", dry_run, "Predicts triangles, memory and bytes, and writes nothing");
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

std::vector<fs::path> inputs_of(const scene::Document& document) {
  std::vector<fs::path> out;
  const auto add = [&](const std::string& path) {
    if (!path.empty()) out.push_back(io::split_source(document.resolve(path).string(), {}).file);
  };
  add(document.terrain.source);
  add(document.terrain.domain);
  for (const scene::Layer& layer : document.layers)
    for (const std::string& path : scene::paths_of(layer)) add(path);
  return out;
}

void write_file(const fs::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace tafoni::cli
