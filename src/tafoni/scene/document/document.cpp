// The tables of parameters that reading, writing, --set and the reference share, and the checks that no
// single parameter can make.
#include "tafoni/scene/document/document.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/files.h"
#include "tafoni/io/csv.h"
#include "tafoni/io/source_name.h"
#include "tafoni/scene/document/impl/types.h"
#include "tafoni/scene/layers/layer.h"

namespace tafoni::scene {

const std::vector<ParamInfo>& scene_params() {
  using S = SceneSettings;
  static const std::vector<ParamInfo> params =
      ParamTable<S>()
          .integer("seed", &S::seed, "", 0, std::int64_t{1} << 53,
                   "Seed that every random choice is made from")
          .real("voxel", &S::voxel, "m", 0, 1e5,
                "Size of a cell of the lattice: smaller shows more detail and takes more time and memory; 0 "
                "chooses "
                "it from the terrain's pixel size and extent")
          .choice("boundary", &S::boundary, {"solid", "open"},
                  "How the mesh ends: solid closes it with walls and a base, open leaves a sheet of terrain")
          .real("plants", &S::plants, "", 0, 1,
                "How green gentle ground is coloured: 1 is a meadow, 0 a desert")
          .real("min_fragment", &S::min_fragment, "m3", 0, 1e12,
                "Floating pieces with less volume, or of only a few cells, are removed; 0 keeps all")
          .real("simplify", &S::simplify, "m", 0, 1e4,
                "How far a simplified mesh may stray: more leaves fewer triangles; 0 keeps every triangle");
  return params;
}

const std::vector<ParamInfo>& terrain_params() {
  using S = TerrainSection;
  static const std::vector<ParamInfo> params =
      ParamTable<S>()
          .text("source", &S::source,
                "Path of an elevation model, anything that GDAL reads; or of a volume, for its upper surface")
          .text("generator", &S::generator, "Name of a built-in generator, in place of a source")
          .numbers("window", &S::window, "pixels", 4, 0, 2147483647,
                   "Column, row, width and height of the part to read, as gdal_translate -srcwin")
          .real("resolution", &S::resolution, "m", 0, 1e5,
                "Pixel size to bring the source to; 0 keeps its own")
          .real("influence", &S::influence, "m", 1e-3, 1e5,
                "How far from the surface the field reaches, R: landforms act within about that depth")
          .real("amplitude", &S::amplitude, "m", 1e-3, 1e5,
                "The field's greatest magnitude, T; R must not exceed 3 T")
          .choice("interpolation", &S::interpolation, {"bicubic", "bilinear"},
                  "How heights between pixel centres are found: bicubic is smooth, bilinear shows the pixels")
          .choice("distance", &S::distance, {"first-order", "vertical"},
                  "How the distance to the surface is taken: first-order divides by the length of the "
                  "gradient, vertical "
                  "goes straight up and down")
          .real("fill", &S::fill, "m", -1, 1e6,
                "Holes that reach no farther than this from data are filled; -1 means eight pixels")
          .boolean("smooth", &S::smooth, "Removes the terraces of 8-bit and other stepped data")
          .integer("band", &S::band, "", 0, 65535, "Band of the source, from 1; 0 finds the elevations")
          .real("pixel_size", &S::pixel_size, "m", 0, 1e5,
                "Pixel size of a source without georeference; 0 means 1 m")
          .choice(
              "encoding", &S::encoding,
              {"auto", "heights", "heightmap", "terrain-rgb", "mapbox", "terrarium"},
              "How the source's numbers mean heights: as they stand, 512 m from black to white as in "
              "game engines, or in the colours of Mapbox's Terrain-RGB, also called mapbox, or of Mapzen's "
              "Terrarium; auto tells it from the source")
          .real(
              "height_scale", &S::height_scale, "m", -1e5, 1e5,
              "Metres in a stored unit of height, negative for depths, which are positive downwards; 0 takes "
              "what the source says")
          .real("height_offset", &S::height_offset, "m", -1e5, 1e5, "Metres to add to every height")
          .numbers("raw_size", &S::raw_size, "pixels", 2, 2, 1e6,
                   "Columns and rows of a source without a header; none takes it as a square")
          .choice("byte_order", &S::byte_order, {"auto", "little", "big"},
                  "Which byte of a number comes first in a source without a header, the least significant or "
                  "the most; auto takes the one that makes the terrain smoother")
          .text(
              "crs", &S::crs,
              "CRS of a source whose coordinates name none, as EPSG:NUMBER or WKT; none takes them as metres")
          .real("depth", &S::depth, "m", 0, 1e5,
                "How much rock is kept below the lowest height, beyond R: caves go no deeper")
          .text("domain", &S::domain, "Path of a polygon file that limits the terrain");
  return params;
}

const std::vector<ParamInfo>& geology_params() {
  using S = GeologySettings;
  static const std::vector<ParamInfo> params =
      ParamTable<S>()
          .text("name", &S::name, "Name by which --set calls it")
          .integer("seed", &S::seed, "", -1, std::int64_t{1} << 53,
                   "Seed of its own; -1 makes it from the scene's seed and the place in the tree");
  return params;
}

const std::vector<ParamInfo>& layer_params() {
  using S = LayerSettings;
  static const std::vector<ParamInfo> params =
      ParamTable<S>()
          .text("name", &S::name,
                "Name by which messages, --set and the report call the layer; none takes its type")
          .boolean("enabled", &S::enabled, "Whether the layer is built; false leaves it out")
          .text("region", &S::region,
                "Path of a polygon file, inside of which alone the layer acts; none leaves it free")
          .numbers("altitude", &S::altitude, "m", 2, -2e4, 2e4,
                   "Lowest and highest elevation between which alone the layer acts; none leaves it free")
          .numbers("box", &S::box, "m", 6, -1e9, 1e9,
                   "West, south, bottom, east, north and top, in the scene's CRS, of the box inside of which "
                   "alone the "
                   "layer acts; none leaves it free")
          .text("mask", &S::mask,
                "Path of a raster, or paint:NAME for what strokes paint: the layer acts where it is above 0, "
                "the more the nearer to 1, which is 255 or 65535 in a painted one; none leaves it free")
          .text("points", &S::points,
                "Path of a CSV (x,y,z) of places in the scene's CRS that a landform starts from; none lets "
                "it choose")
          .integer("seed", &S::seed, "", -1, std::int64_t{1} << 53,
                   "Seed of its own; -1 makes it from the scene's seed and the layer's type and name");
  return params;
}

const std::string& shown_name(const Layer& layer) {
  return layer.settings.name.empty() ? layer.type : layer.settings.name;
}

std::string_view painted_mask(const Layer& layer) {
  constexpr std::string_view prefix = "paint:";
  const std::string_view mask = layer.settings.mask;
  return mask.starts_with(prefix) ? mask.substr(prefix.size()) : std::string_view();
}

std::vector<std::string*> paths_of(Layer& layer) {
  LayerSettings& s = layer.settings;
  std::vector<std::string*> out;
  const auto add = [&](std::string& path) {
    if (!path.empty()) out.push_back(&path);
  };
  add(s.region);
  if (painted_mask(layer).empty()) add(s.mask);
  add(s.points);
  for (const std::string& name : find_layer_type(layer.type).paths)
    if (const auto found = layer.values.find(name); found != layer.values.end())
      add(std::get<std::string>(found->second));
  return out;
}

std::vector<std::string> paths_of(const Layer& layer) {
  Layer copy = layer;
  std::vector<std::string> out;
  for (const std::string* path : paths_of(copy)) out.push_back(*path);
  return out;
}

std::filesystem::path Document::resolve(const std::string& path) const {
  io::SourceName name = io::split_source(path, directory);
  if (name.file.empty()) return path;
  if (!name.file.is_absolute() && !directory.empty()) name.file = directory / name.file;
  name.file = tidy(name.file);
  return name.text();
}

namespace {

bool same_settings(const std::vector<ParamInfo>& infos, const void* a, const void* b) {
  return std::all_of(infos.begin(), infos.end(),
                     [&](const ParamInfo& info) { return info.load(info, a) == info.load(info, b); });
}

bool same_geology(const GeologySettings& a, const GeologySettings& b) {
  return a.type == b.type && a.values == b.values && same_settings(geology_params(), &a, &b) &&
         std::equal(a.of.begin(), a.of.end(), b.of.begin(), b.of.end(), same_geology);
}

/// "a, b and c".
std::string enumerate(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return out;
}

}  // namespace

std::string place_of(const Document& document, const Layer& layer) {
  return place_of(document, {{"", layer.line}}, "");
}

std::string place_of(const Document& document, const Lines& section, std::string_view key) {
  auto found = section.find(key);
  if (found == section.end()) found = section.find("");
  if (document.file.empty() || found == section.end() || found->second <= 0) return {};
  return fmt::format("{}:{}: ", document.file, found->second);
}

bool same(const Document& a, const Document& b) {
  const auto same_layer = [](const Layer& p, const Layer& q) {
    return p.type == q.type && p.values == q.values &&
           same_settings(layer_params(), &p.settings, &q.settings);
  };
  return same_settings(scene_params(), &a.scene, &b.scene) &&
         same_settings(terrain_params(), &a.terrain, &b.terrain) && a.terrain.values == b.terrain.values &&
         std::equal(a.geology.begin(), a.geology.end(), b.geology.begin(), b.geology.end(), same_geology) &&
         std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(), same_layer);
}

// Nothing that anyone can mean is finer, and far finer lengths are beyond what numbers hold.
static constexpr double least_length = 1e-4;

namespace {

/// `at` is the layer's place.
void check(const Layer& layer, const std::string& at) {
  const LayerSettings& s = layer.settings;
  if (s.mask == "paint:")
    fail(ErrorKind::input, "{}mask = \"paint:\" names no mask; write one that strokes paint, as paint:region",
         at);
  if (!s.altitude.empty() && s.altitude[0] > s.altitude[1])
    fail(ErrorKind::input, "{}altitude = {} of layer {} has its ends swapped", at, to_toml(s.altitude),
         layer.type);
  if (!s.box.empty() && (s.box[0] > s.box[3] || s.box[1] > s.box[4] || s.box[2] > s.box[5]))
    fail(ErrorKind::input, "{}box = {} of layer {} is empty; it is west, south, bottom, east, north, top", at,
         to_toml(s.box), layer.type);
  const LayerType& type = find_layer_type(layer.type);
  for (const auto& [name, what] : type.needs)
    if (!layer.values.contains(name))
      fail(ErrorKind::input, "{}a {} layer needs {}, {}", at, layer.type, name, what);
  for (const std::string& name : type.leaves_out)
    if (const ParamInfo& info = find_param(layer_params(), name, at); info.load(info, &s) != info.init)
      fail(ErrorKind::input, "{}a {} layer {}; leave out {}", at, layer.type, type.because,
           enumerate(type.leaves_out));
}

}  // namespace

void check(const Document& document) {
  const TerrainSection& t = document.terrain;
  const std::string scene = document.file.empty() ? "the scene: " : document.file + ": ";
  const auto at = [&](const Lines& section, std::string_view key) {
    const std::string place = place_of(document, section, key);
    return place.empty() ? scene : place;
  };
  if (t.source.empty() && t.generator.empty())
    fail(ErrorKind::input, "{}[terrain] needs a source (a path) or a generator", at(t.lines, "source"));
  if (!t.source.empty() && !t.generator.empty())
    fail(ErrorKind::input, "{}[terrain] has both a source and a generator; keep one",
         at(t.lines, "generator"));
  struct Length {
    const char* name;
    double metres;
    const Lines& lines;
  };
  for (const auto& [name, metres, lines] :
       {Length{"voxel", document.scene.voxel, document.scene.lines},
        Length{"resolution", t.resolution, t.lines}, Length{"pixel_size", t.pixel_size, t.lines}})
    if (metres > 0 && metres < least_length)
      fail(ErrorKind::input, "{}{} = {} m is less than {} m; give more, or 0 to leave it open",
           at(lines, name), name, metres, least_length);
  if (t.influence > 3 * t.amplitude)
    fail(ErrorKind::input,
         "{}influence = {} m is more than three times amplitude = {} m, where the field stops growing with "
         "depth; raise the amplitude to at least {:.6g} m or lower the influence",
         at(t.lines, t.lines.contains("influence") ? "influence" : "amplitude"), t.influence, t.amplitude,
         t.influence / 3);
  if (!t.window.empty() && !t.generator.empty())
    fail(ErrorKind::input, "{}window is for a source; a generator takes width and height",
         at(t.lines, "window"));
  if (!t.window.empty() && (t.window[2] < 1 || t.window[3] < 1))
    fail(ErrorKind::input, "{}window = {} has no pixels; it is column, row, width, height",
         at(t.lines, "window"), to_toml(t.window));
  for (const auto& [name, pixels] : {std::pair{"window", &t.window}, std::pair{"raw_size", &t.raw_size}})
    for (const double v : *pixels)
      if (v != std::trunc(v))
        fail(ErrorKind::input, "{}{} = {} must be whole pixels", at(t.lines, name), name, to_toml(*pixels));
  for (const Layer& layer : document.layers) check(layer, at({{"", layer.line}}, ""));
}

namespace {

void set_value(const std::vector<ParamInfo>& common, void* object, const std::vector<ParamInfo>& own,
               Values& values, std::string_view name, std::string_view text, std::string_view where) {
  const auto infos = impl::join_params(common, own);
  const ParamInfo& info = find_param(infos, name, where);
  impl::store(common, object, values, info, parse_value(info, text, where));
}

bool matches(const std::string& type, const std::string& name, std::string_view target,
             std::vector<std::string>& known) {
  known.push_back(name.empty() ? type : name);
  return type == target || name == target;
}

/// Calls set(geology) for all that match, nested or not; says whether there was one.
template <class Set>
bool each_match(std::vector<GeologySettings>& list, std::string_view target, std::vector<std::string>& known,
                const Set& set) {
  bool found = false;
  for (GeologySettings& geology : list) {
    if (matches(geology.type, geology.name, target, known)) {
      set(geology);
      found = true;
    }
    found |= each_match(geology.of, target, known, set);
  }
  return found;
}

}  // namespace

void set(Document& document, std::string_view assignment) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.substr(0, equals).rfind('.');
  const std::string where = fmt::format("--set {}", assignment);
  if (equals == std::string_view::npos || dot == std::string_view::npos)
    fail(ErrorKind::usage, "{}: expected TARGET.NAME=VALUE, as in sea-cliff.range=8", where);
  const std::string_view target = assignment.substr(0, dot);
  const std::string_view name = assignment.substr(dot + 1, equals - dot - 1);
  const std::string_view text = assignment.substr(equals + 1);
  static const std::vector<ParamInfo> none;

  Values no_values;
  // The text's line says something else from now on.
  const auto forget = [name](Lines& lines) {
    if (const auto line = lines.find(name); line != lines.end()) lines.erase(line);
  };
  if (target == "scene") {
    forget(document.scene.lines);
    return set_value(scene_params(), &document.scene, none, no_values, name, text, where);
  }
  if (target == "terrain") {
    TerrainSection& t = document.terrain;
    forget(t.lines);
    return set_value(terrain_params(), &t,
                     t.generator.empty() ? none : impl::params_of_generator(t.generator), t.values, name,
                     text, where);
  }
  std::vector<std::string> known = {"scene", "terrain"};
  bool found = each_match(document.geology, target, known, [&](GeologySettings& g) {
    set_value(geology_params(), &g, impl::params_of_geology(g.type), g.values, name, text, where);
  });
  for (Layer& layer : document.layers) {
    if (!matches(layer.type, layer.settings.name, target, known)) continue;
    set_value(layer_params(), &layer.settings, params_of_layer(layer.type), layer.values, name, text, where);
    found = true;
  }
  if (found) return;
  const std::string near = nearest(target, known);
  fail(ErrorKind::usage, "{}: the scene has no layer or geology \"{}\"{}", where, target,
       near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near));
}

Document load_scene(const std::filesystem::path& file) {
  // Words of the largest scene take some hundred kilobytes; a file far beyond is another one.
  constexpr std::uint64_t largest_scene = std::uint64_t{16} << 20;
  Document document = parse_scene(io::read_text(file, largest_scene), file);
  document.directory = follow_links(file).parent_path();
  return document;
}

}  // namespace tafoni::scene
