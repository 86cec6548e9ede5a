#pragma once
// What amplify, build, query and render share: a document from the command line, and its outputs.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "args.h"
#include "console.h"

#include "tafoni/mesh/mesh.h"
#include "tafoni/render/render.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/document/document.h"

namespace tafoni::cli {

/// Options that override what a scene says.
struct SceneOptions {
  std::vector<std::string> set;
  std::string dem;
  std::vector<double> window;
  std::optional<double> resolution, voxel, simplify;
  std::optional<std::int64_t> seed;
  std::string boundary;

  void declare(Args& args);
  void apply(scene::Document& document) const;
};

/// What a build leaves behind.
struct OutputOptions {
  std::vector<std::string> files;  ///< meshes and volumes
  std::string preview, save_scene, report;
  std::optional<std::int64_t> tiles;
  std::optional<double> band;
  std::string values;             ///< of volumes: distance, field, or empty for what the format usually has
  std::optional<double> texture;  ///< metres that a picture covers
  bool half = false;
  bool dry_run = false;

  void declare(Args& args);
  /// Whether anything is asked for that takes building the scene.
  bool builds() const { return !files.empty() || !preview.empty() || !report.empty(); }
};

/// A scene file (.toml), or a scene of nothing but an elevation model or a volume.
scene::Document open_document(const std::string& path);
bool is_scene_file(const std::string& path);
/// Whether a path is that of a mesh, which its extension says.
bool is_mesh_file(const std::string& path);

/// Builds, meshes and writes. Every output is checked before the work begins. `scene_file` is where the
/// document came from, or empty.
void run_scene(const scene::Document& document, const std::string& scene_file, const OutputOptions& outputs,
               Console& console);

/// Throws Error{output} when `path` could not be written, Error{usage} when it is one of `inputs`.
void check_output(const std::filesystem::path& path, const std::vector<std::filesystem::path>& inputs);
/// The paths of all files that a document reads.
std::vector<std::filesystem::path> inputs_of(const scene::Document& document);

void write_file(const std::filesystem::path& path, const std::string& text);

}  // namespace tafoni::cli
