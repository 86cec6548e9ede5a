// A build goes through its stages: elevations, ground, geology, layers from below. Each stage is a memo
// (memo.h): this file gathers the parts that it is made from, out of the document and the stages before.
#include "tafoni/scene/build/impl/builder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/io/dem.h"
#include "tafoni/io/source_name.h"
#include "tafoni/scene/build/impl/base.h"
#include "tafoni/scene/build/impl/outside.h"

namespace tafoni::scene::impl {
namespace {

// A landform bends the rock within the influence, so a lattice of fewer cells across it loses what is a few
// metres large.
constexpr double least_cells_per_influence = 4;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

double choose_voxel(const Document& document, const raster::Raster& elevations) {
  if (document.scene.voxel > 0) return document.scene.voxel;
  // A lattice on a volume's own samples loses nothing of it.
  return is_volume(document.terrain) ? elevations.placement.dx
                                     : default_voxel(elevations, document.terrain.influence);
}

void warn_of_coarse_voxel(const raster::Raster& elevations, double voxel, Progress& progress) {
  const double pixel = std::max(elevations.placement.dx, elevations.placement.dy);
  if (voxel < pixel)
    progress.warn(
        fmt::format("the pixels of {:g} m are so large that the voxel was set to {:g} m, too coarse for "
                    "landforms of a few "
                    "metres; choose a smaller voxel",
                    pixel, voxel));
  else
    progress.warn(fmt::format(
        "the terrain is so large that the voxel was set to {:g} m, too coarse for landforms of a few metres; "
        "choose a part of it with --window (or window = […]), or a smaller voxel",
        voxel));
}

/// West, south, east, north.
std::vector<double> outline_of(const raster::Raster& r) {
  const raster::Placement& p = r.placement;
  return {p.west, p.north - p.dy * r.height(), p.west + p.dx * r.width(), p.north};
}

Below below_layers(const Keyed<Ground>& ground, const Keyed<geology::GeologyPtr>& geology) {
  return {ground.value.terrain, ground.value.settings, geology.value, ground.value.open};
}

Below below_next(const Keyed<Below>& below, const Keyed<landforms::Result>& made) {
  Below out = below.value;
  out.open = landforms::apply_to(out.open, made.value);
  return out;
}

void warn_of_nothing(const Layer& layer, Progress& progress) {
  const LayerSettings& s = layer.settings;
  const bool limited = !(s.region.empty() && s.mask.empty() && s.altitude.empty() && s.box.empty());
  const auto all = landforms::all_landforms();
  const bool landform = std::any_of(all.begin(), all.end(), [&](const landforms::LandformType* type) {
    return type->about.name == layer.type;
  });
  progress.warn(
      fmt::format("layer {}: it finds nothing to act on{}, and makes nothing{}", shown_name(layer),
                  limited ? " where it may act" : "",
                  landform ? fmt::format("; `tafoni list {}` says what it looks for", layer.type) : ""));
}

void warn_of_mask(const Layer& layer, std::string_view mask, const std::vector<Slot>& strokes,
                  Progress& progress) {
  if (!paint_strokes(strokes, mask).strokes.empty()) return;
  const std::string near = nearest(mask, painted_masks(strokes));
  progress.warn(fmt::format(
      "layer {}: no stroke that acts paints its mask \"{}\", so that it makes nothing{}", shown_name(layer),
      mask, near.empty() ? "" : fmt::format("; did you mean paint:{}?", near)));
}

/// What `make` makes; its errors begin with the place of what the document says of it.
template <class Make>
auto at_line(const Document& document, const Lines& section, std::string_view key, const Make& make) {
  try {
    return make();
  } catch (const Error& error) {
    const std::string place = place_of(document, section, key);
    if (error.kind() == ErrorKind::cancelled || place.empty()) throw;
    fail(error.kind(), "{}{}", place, error.what());
  }
}

/// A layer's own words, without those that do not change what it makes.
Layer words_of(Layer layer) {
  layer.settings.name.clear();
  layer.settings.seed = -1;
  return layer;
}

}  // namespace

/// What a build has come to.
struct Builder::Stage {
  const Document& document;
  const SlotSource& slots;
  Readers readers;
  double voxel = 0;
  double base = 0;
  std::string crs;
  Keyed<Ground> ground;
  Keyed<geology::GeologyPtr> geology;
  Keyed<Below> below;
  std::vector<BuiltLayer> layers;
  std::vector<LayerResult> results;
  std::vector<std::pair<std::string, double>> seconds;

  /// Of all layers that act.
  std::vector<Slot> strokes() const {
    std::vector<Slot> out;
    for (const Layer& layer : document.layers) {
      if (!find_layer_type(layer.type).takes_strokes || !layer.settings.enabled) continue;
      const auto more = slots(document, layer);
      out.insert(out.end(), more.begin(), more.end());
    }
    return out;
  }
};

Built Builder::build(const Document& document, const SlotSource& slots, Progress& progress) {
  check(document);
  Stage stage{document, slots, {progress, volumes_}, 0, 0, {}, {}, {}, {}, {}, {}, {}};
  build_ground(stage);
  build_geology(stage);
  build_layers(stage);
  lay_base(stage);
  const Below& below = stage.below.value;
  BuiltScene scene;
  scene.document = document;
  scene.voxel = stage.voxel;
  scene.crs = std::move(stage.crs);
  scene.terrain = below.terrain;
  scene.terrain.box.lo.z = stage.base;
  scene.settings = below.settings;
  scene.geology = below.geology;
  scene.layers = std::move(stage.results);
  scene.open = below.open;
  scene.solid = field::intersect({below.open, terrain::domain_tree(scene.terrain, scene.settings)});
  scene.seconds = std::move(stage.seconds);
  return {std::make_shared<BuiltScene>(std::move(scene)), stage.ground.key, stage.base,
          std::move(stage.layers)};
}

terrain::Terrain Builder::terrain(const Document& document, Progress& progress) {
  const SlotSource none = [](const Document&, const Layer&) { return std::vector<Slot>(); };
  Stage stage{document, none, {progress, volumes_}, 0, 0, {}, {}, {}, {}, {}, {}, {}};
  build_ground(stage);
  return stage.ground.value.terrain;
}

/// The file at a path, with a digest of what it holds; nothing where no path is named.
std::optional<File> Builder::file(const Document& document, const std::string& path) {
  if (path.empty()) return {};
  const auto resolved = document.resolve(path);
  return File{resolved, files_.of(io::split_source(resolved.string(), {}).file)};
}

void Builder::build_ground(Stage& stage) {
  const Document& document = stage.document;
  const TerrainSection& t = document.terrain;
  Progress& progress = stage.readers.progress;
  Stopwatch watch;
  const std::uint64_t seed = t.generator.empty() ? 0 : document.scene.seed;
  if (!t.crs.empty()) at_line(document, t.lines, "crs", [&] { io::check_crs(t.crs); });
  const auto elevations = at_line(document, t.lines, t.source.empty() ? "generator" : "source", [&] {
    return elevations_(words_of_elevations(t), seed, file(document, t.source), stage.readers);
  });
  stage.seconds.emplace_back("read terrain", watch.seconds());
  stage.crs = elevations.value->crs;
  stage.voxel = choose_voxel(document, *elevations.value);
  if (document.scene.voxel <= 0 && !is_volume(t) && !document.layers.empty() &&
      stage.voxel > t.influence / least_cells_per_influence)
    warn_of_coarse_voxel(*elevations.value, stage.voxel, progress);

  watch = {};
  stage.ground = at_line(document, t.lines, "domain", [&] {
    return grounds_(elevations, words_of_field(t), stage.voxel, file(document, t.domain), progress);
  });
  stage.seconds.emplace_back("terrain", watch.seconds());
}

void Builder::build_geology(Stage& stage) {
  const Document& document = stage.document;
  stage.geology = geologies_(document.geology, static_cast<std::uint64_t>(document.scene.seed),
                             stage.ground.value.terrain.origin, stage.readers.progress);
}

Keyed<RegionPtr> Builder::region_of(const Stage& stage, const Layer& layer, Progress& progress) {
  const LayerSettings& s = layer.settings;
  Limits limits;
  limits.altitude = s.altitude;
  limits.box = s.box;
  limits.polygons = file(stage.document, s.region);
  if (const std::string_view name = painted_mask(layer); !name.empty()) {
    limits.painted = {paint_strokes(stage.strokes(), name),
                      {stage.ground.value.terrain.heights, stage.ground.key}};
  } else {
    limits.mask = file(stage.document, s.mask);
    if (limits.mask) limits.outline = outline_of(*stage.ground.value.terrain.heights);
  }
  if (!limits.any()) return {};
  limits.origin = stage.ground.value.terrain.origin;
  limits.crs = stage.crs;
  return regions_(limits, progress);
}

BuiltLayer Builder::build_layer(Stage& stage, std::size_t index) {
  const Document& document = stage.document;
  const Layer& layer = document.layers[index];
  const LayerType& type = find_layer_type(layer.type);
  const auto region = region_of(stage, layer, stage.readers.progress);
  const auto files = [&] {
    std::map<std::string, File> out;
    const auto add = [&](const std::string& name, const std::string& path) {
      if (auto found = file(document, path)) out.emplace(name, std::move(*found));
    };
    add("points", layer.settings.points);
    for (const std::string& name : type.paths)
      if (const auto found = layer.values.find(name); found != layer.values.end())
        add(name, std::get<std::string>(found->second));
    return out;
  };
  const auto strokes = [&] { return stage.slots(document, layer); };
  const LayerSite site{shown_name(layer),
                       stage.below,
                       words_of(layer),
                       layer_seed(document, index),
                       region,
                       files,
                       strokes,
                       results_,
                       memories_[&type],
                       stage.readers};
  BuiltLayer out = type.build(site);
  out.type = &type;
  out.region = region.value;
  return out;
}

void Builder::build_layers(Stage& stage) {
  const Document& document = stage.document;
  stage.below = make_keyed(&below_layers, stage.ground, stage.geology);
  for (std::size_t i = 0; i < document.layers.size(); ++i) {
    const Layer& layer = document.layers[i];
    if (!layer.settings.enabled) continue;
    const Stopwatch watch;
    const std::uint64_t warned = stage.readers.progress.warned();
    try {
      stage.layers.push_back(build_layer(stage, i));
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::cancelled) throw;
      std::string_view what = error.what();
      if (const std::string type = layer.type + ": "; what.starts_with(type)) what.remove_prefix(type.size());
      // What a file says is input, however it came to be wrong.
      const bool read = layer.line > 0 && error.kind() == ErrorKind::usage;
      fail(read ? ErrorKind::input : error.kind(), "{}layer {}: {}", place_of(document, layer),
           shown_name(layer), what);
    }
    const BuiltLayer& made = stage.layers.back();
    warn_of_layer_beside(stage.below.value.terrain, shown_name(layer), made.made.value, made.region.get(),
                         stage.readers.progress);
    // Strokes may come later, and what was there before was told before.
    if (!made.reused && !made.type->takes_strokes && !made.made.value.reshape &&
        made.made.value.nodes.empty()) {
      if (const std::string_view mask = painted_mask(layer); !mask.empty())
        warn_of_mask(layer, mask, stage.strokes(), stage.readers.progress);
      if (stage.readers.progress.warned() == warned) warn_of_nothing(layer, stage.readers.progress);
    }
    const double seconds = watch.seconds();
    stage.results.push_back({shown_name(layer), layer.type, made.made.value, seconds, made.reused});
    stage.seconds.emplace_back(shown_name(layer), seconds);
    stage.below = make_keyed(&below_next, stage.below, made.made);
  }
}

void Builder::lay_base(Stage& stage) {
  const Stopwatch watch;
  const Below& below = stage.below.value;
  double lowest = below.terrain.box.lo.z;
  for (const BuiltLayer& layer : stage.layers) {
    const double own = landforms::lowest_change(layer.made.value);
    if (std::isfinite(own)) lowest = std::min(lowest, own);
  }
  stage.base = base_of({below.terrain, below.open, lowest, stage.voxel, below.settings.influence},
                       stage.readers.progress);
  if (stage.base < below.terrain.box.lo.z) stage.seconds.emplace_back("base", watch.seconds());
}

namespace {

/// Whether two layers at the same place may stay, with the boxes in which they differ.
bool alike(const BuiltLayer& before, const BuiltLayer& now, std::vector<Box3d>& out) {
  return before.type == now.type && now.type->changed(&before, &now, out);
}

}  // namespace

std::vector<Box3d> changed_boxes(const Built& before, const Built& now) {
  if (before.ground != now.ground) return {Box3d::everything()};
  std::vector<Box3d> out;
  const auto &a = before.layers, &b = now.layers;
  std::size_t first = 0;
  while (first < a.size() && first < b.size() && alike(a[first], b[first], out)) ++first;
  std::size_t same = 0;
  while (same < a.size() - first && same < b.size() - first &&
         alike(a[a.size() - 1 - same], b[b.size() - 1 - same], out))
    ++same;
  for (std::size_t i = first; i < a.size() - same; ++i) a[i].type->changed(&a[i], nullptr, out);
  for (std::size_t i = first; i < b.size() - same; ++i) b[i].type->changed(nullptr, &b[i], out);
  if (before.base != now.base) {
    Box3d under = Box3d::everything();
    under.hi.z = std::max(before.base, now.base) + now.scene->settings.influence;
    out.push_back(under);
  }
  std::erase_if(out, [](const Box3d& box) { return box.empty(); });
  return out;
}

}  // namespace tafoni::scene::impl
