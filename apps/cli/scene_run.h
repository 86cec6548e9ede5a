#pragma once
// What amplify, build, query and render share: a document from the command line, and its outputs.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "args.h"
#include "command_files.h"
#include "console.h"

#include "tafoni/core/error.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/render/render.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/products/volume_scene.h"

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
  /// Throws Error{usage} for what does not go together, wherever it came from.
  void apply(scene::Document& document) const;
  /// Throws Error{usage} where one is given for a mesh, but for the seed where it counts.
  void check_unused(const std::string& file, bool seed_counts = false) const;
  /// Throws Error{usage} "OPTION: REASON" where one is given.
  void check_none(const std::string& reason) const;

 private:
  /// The options that are given.
  std::vector<const char*> given() const;
};

/// What a build leaves behind.
struct OutputOptions {
  std::vector<std::string> files;  ///< meshes and volumes
  std::string preview, save_scene, report;
  std::optional<std::int64_t> tiles;
  std::optional<double> band;
  std::string values;             ///< of volumes: distance, field, or empty for what the format usually has
  std::optional<double> texture;  ///< metres that a picture covers
  std::string up;                 ///< "y", "z" or empty
  bool world_coordinates = false;
  bool float_colors = false;
  bool half = false;
  bool dry_run = false;
  bool force = false;

  void declare(Args& args);
  /// Whether anything is asked for that takes building the scene.
  bool builds() const { return !files.empty() || !preview.empty() || !report.empty(); }
  /// Whether there is anything to do for run_scene().
  bool any() const { return builds() || !save_scene.empty() || dry_run; }
};

using scene::is_scene_file;
using scene::open_document;
/// Whether a path is that of a mesh, which its extension says.
bool is_mesh_file(const std::string& path);

/// What `make` gives; what it says is wrong is said of the file.
template <class Make>
auto of_file(const std::string& path, const Make& make) {
  try {
    return make();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    fail(ErrorKind::input, "{}: {}", path, error.what());
  }
}

/// Builds, meshes and writes. Every output is checked before the work begins. `scene_file` is where the
/// document came from, or empty.
void run_scene(const scene::Document& document, const std::string& scene_file, const OutputOptions& outputs,
               Console& console);
/// The check alone, for a command that changes something before it runs the scene. `files` has what else the
/// command reads and writes.
void check_outputs(const scene::Document& document, const std::string& scene_file,
                   const OutputOptions& outputs, CommandFiles files = {});

/// The paths of all files that a document reads.
std::vector<std::filesystem::path> inputs_of(const scene::Document& document);

void write_file(const std::filesystem::path& path, const std::string& text);

}  // namespace tafoni::cli
