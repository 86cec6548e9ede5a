#pragma once
// The scene document: plain settings, read from and written to TOML. Everything else is built from it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/params.h"

namespace tafoni::scene {

/// Where a section stands in Document::text: the line of its header under "", of its keys under their names.
using Lines = std::map<std::string, int, std::less<>>;

/// [scene]
struct SceneSettings {
  std::int64_t seed = 0;
  double voxel = 0;  ///< metres; 0: chosen from the terrain's pixel size and extent
  std::string boundary = "solid";
  double plants = 1;           ///< how green gentle ground is coloured
  double min_fragment = 1000;  ///< m³; smaller floating pieces are removed
  double simplify = 0;         ///< metres; 0: keep every triangle
  Lines lines;                 ///< empty: not from a text
};
const std::vector<ParamInfo>& scene_params();

/// [terrain]. Either `source` or `generator` is set in a document that can be built.
struct TerrainSection {
  /// Path, or a name that only GDAL knows (io/source_name.h), as the scene file says it; of a volume, its
  /// upper surface is taken.
  std::string source;
  std::string generator;       ///< a registered generator; `values` are its parameters
  std::vector<double> window;  ///< column, row, width, height in pixels of the source; empty: all
  double resolution = 0;       ///< metres; 0: the source's own
  double influence = 15;       ///< R, metres
  double amplitude = 7.5;      ///< T, metres; R <= 3T
  std::string interpolation = "bicubic";
  std::string distance = "first-order";
  double fill = -1;               ///< metres, io::DemOptions::fill_distance; -1: eight pixels
  bool smooth = false;            ///< removes the terraces of stepped data
  std::int64_t band = 0;          ///< 0: the one that holds elevations
  double pixel_size = 0;          ///< metres, of a file without georeference; 0: 1 m
  std::string encoding = "auto";  ///< how the source's numbers mean heights
  double height_scale = 0;        ///< metres a stored unit, negative for depths; 0: the file's own
  double height_offset = 0;       ///< metres, added to every height
  std::vector<double> raw_size;   ///< columns and rows of a file without a header; empty: square
  std::string byte_order = "auto";
  std::string crs;     ///< of a source whose coordinates name none
  double depth = 0;    ///< metres of rock below the R that is always there
  std::string domain;  ///< path of a polygon file; empty: the whole raster
  Values values;       ///< of the generator; only what differs from its defaults
  Lines lines;         ///< empty: not from a text
};
const std::vector<ParamInfo>& terrain_params();

/// One [[geology]]; several are blended. What it folds, faults or blends is nested: [[geology.of]],
/// [[geology.of.of]] and so on.
struct GeologySettings {
  std::string type;
  Values values;
  int line = 0;  ///< of its header in Document::text; 0: not from there
  std::string name = {};
  std::int64_t seed = -1;  ///< -1: made from the scene's seed and the place in the tree
  std::vector<GeologySettings> of = {};
};
/// What every geology can say besides its own kind's parameters.
const std::vector<ParamInfo>& geology_params();

/// What every [[layer]] can say besides its own type's parameters.
struct LayerSettings {
  std::string name;
  bool enabled = true;
  std::string region;            ///< path of a polygon file
  std::vector<double> altitude;  ///< lo, hi: world elevations
  std::vector<double> box;       ///< west, south, bottom, east, north, top: scene CRS
  std::string mask;              ///< path of a raster, or "paint:NAME" for one that strokes paint
  std::string points;            ///< path of a CSV of seed points
  std::int64_t seed = -1;        ///< -1: made from the scene's seed, the layer's type and name
};
const std::vector<ParamInfo>& layer_params();

/// What one [[layer]] of a scene file says.
struct Layer {
  std::string type;  ///< a registered one (layers/layer.h): every landform, and more
  LayerSettings settings;
  Values values;
  int line = 0;  ///< of its header in Document::text; 0: not from there
};
/// The parameters of a layer type beyond layer_params(). Throws Error{usage} naming the nearest known type.
const std::vector<ParamInfo>& params_of_layer(std::string_view type);
/// What messages call a layer: its name or else its type.
const std::string& shown_name(const Layer& layer);
/// The paths of files that a layer names, for reading or changing them. None is empty.
std::vector<std::string*> paths_of(Layer& layer);
std::vector<std::string> paths_of(const Layer& layer);
/// The NAME of a layer whose mask is "paint:NAME"; empty for any other.
std::string_view painted_mask(const Layer& layer);

struct Document {
  std::filesystem::path directory;  ///< what relative paths are relative to
  std::string file;                 ///< for messages; empty for a new one
  SceneSettings scene;
  TerrainSection terrain;
  std::vector<GeologySettings> geology;
  std::vector<Layer> layers;
  std::string text;  ///< what it was read from, comments and all; empty for a new one

  /// The place of a path; of a name that only GDAL knows, the name with the place of its file.
  std::filesystem::path resolve(const std::string& path) const;
};
/// "FILE:LINE: " of a layer that was read from there, or of a section's key, or else its header; else empty.
std::string place_of(const Document& document, const Layer& layer);
std::string place_of(const Document& document, const Lines& section, std::string_view key);
/// Whether both build the same thing: every setting, but neither `file`, `text` nor lines.
bool same(const Document& a, const Document& b);

/// Reads a document. `file` is for messages and gives the directory; no file is opened. Throws Error{input}:
/// "FILE:LINE: KEY …" with the allowed range or the nearest known key.
Document parse_scene(std::string_view text, const std::filesystem::path& file);
/// The same of a file. Where that is a link, paths are relative to what it leads to.
Document load_scene(const std::filesystem::path& file);

/// The document as TOML: `document.text` with only what changed edited, so that comments stay; a new text
/// where there is none or where an edit would not read back as the same document.
std::string to_text(const Document& document);
/// Writes it whole or not at all, with paths relative to the new file. Throws Error{output}.
void save_scene(const Document& document, const std::filesystem::path& file);

/// `--set TARGET.NAME=TEXT`: the target is scene, terrain, or the name or type of a layer or of a geology,
/// nested or not; all that match are set. Throws Error{usage}.
void set(Document& document, std::string_view assignment);

/// Checks what no single key can say: R <= 3T, source or generator, low < high, what a type of layer needs.
/// Throws Error{input} that begins with the place, or with "the scene".
void check(const Document& document);

}  // namespace tafoni::scene
