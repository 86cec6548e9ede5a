#include "tafoni/scene/build/impl/builder.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/geology/kind.h"
#include "tafoni/io/csv.h"
#include "tafoni/io/dem.h"
#include "tafoni/io/vector.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/raster/resample.h"
#include "tafoni/scene/layers/impl/primitives_layer.h"
#include "tafoni/scene/layers/impl/volume_layer.h"
#include "tafoni/scene/sculpt/journal.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::scene::impl {
namespace {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

field::HeightfieldSettings field_settings(const TerrainSettings& t) {
  return {t.influence, t.amplitude, t.interpolation == "bicubic", t.distance == "first-order"};
}

raster::Raster read_elevations(const Document& document, Progress& progress) {
  const TerrainSettings& t = document.terrain;
  io::DemOptions options;
  if (!t.window.empty()) {
    std::array<int, 4> window{};
    std::transform(t.window.begin(), t.window.end(), window.begin(),
                   [](double v) { return static_cast<int>(v); });
    options.window = window;
  }
  options.resolution = t.resolution;
  options.band = static_cast<int>(t.band);
  options.fill_distance = t.fill;
  options.smooth = t.smooth;
  options.pixel_size = t.pixel_size;
  options.height_scale = t.height_scale;
  return io::read_dem(document.resolved(t.source), options, progress).raster;
}

bool is_volume(const Document& document) {
  return io::can(document.terrain.source, io::Ability::read_volume);
}

double chosen_voxel(const Document& document, const raster::Raster& raster, double influence) {
  if (document.scene.voxel > 0) return document.scene.voxel;
  // On a volume's own samples nothing is lost.
  return is_volume(document) ? raster.placement.dx : default_voxel(raster, influence);
}

/// The geologies of a list, each with a seed of its place.
std::vector<geology::GeologyPtr> geologies_of(const std::vector<GeologySettings>& list, Vec3d origin,
                                              std::uint64_t seed) {
  std::vector<geology::GeologyPtr> out;
  for (const GeologySettings& g : list) {
    const auto own = g.seed >= 0 ? static_cast<std::uint64_t>(g.seed) : hash_combine(seed, out.size());
    out.push_back(geology::make_geology(g.type, g.values, geologies_of(g.of, origin, own), origin, own));
  }
  return out;
}

geology::GeologyPtr geology_of(const Document& document, Vec3d origin) {
  const auto seed = static_cast<std::uint64_t>(document.scene.seed);
  if (document.geology.empty()) return geology::default_geology(origin, seed);
  auto parts = geologies_of(document.geology, origin, seed);
  if (parts.size() == 1) return parts.front();
  return geology::make_geology("blend", {}, std::move(parts), origin, seed);
}

std::vector<landforms::Ring> to_local(std::vector<landforms::Ring> rings, Vec3d origin) {
  for (auto& ring : rings)
    for (Vec2d& p : ring) p = p - Vec2d{origin.x, origin.y};
  return rings;
}

std::vector<field::NodePtr> read_primitives(const Layer& layer, std::uint64_t seed, const BuiltScene& scene,
                                            const landforms::Region* region) {
  PrimitivesSettings settings;
  assign(primitives_params(), &settings, layer.values, "primitives");
  const auto file = scene.document.resolved(settings.file);
  std::function<bool(Vec3d)> keep;
  if (region) keep = [region](Vec3d p) { return region->contains(p); };
  return make_primitives(io::read_text(file), file.string(), settings, scene.terrain.origin,
                         scene.settings.influence, seed, keep);
}

std::string text_value(const Layer& layer, std::string_view name) {
  const auto found = layer.values.find(name);
  return found == layer.values.end() ? std::string() : std::get<std::string>(found->second);
}

bool flag_value(const Layer& layer, std::string_view name, bool otherwise) {
  const auto found = layer.values.find(name);
  return found == layer.values.end() ? otherwise : std::get<bool>(found->second);
}

/// A layer's own words, without those that do not change what it makes.
Digest digest_of(const Layer& layer) {
  Document alone;
  alone.layers = {layer};
  alone.layers[0].settings.name.clear();
  alone.layers[0].settings.seed = -1;
  return Digest().add(std::string_view(to_text(alone)));
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Box3d everywhere{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};

}  // namespace

std::vector<Slot> slots_of(const Document& document, const Layer& layer) {
  std::vector<Slot> out;
  if (const std::string text = text_value(layer, "strokes"); !text.empty()) {
    const auto file = document.resolved(text);
    for (Stroke& stroke : parse_strokes(io::read_text(file), file.string()))
      out.push_back({std::make_shared<Stroke>(std::move(stroke)), false});
  }
  if (const std::string file = text_value(layer, "journal"); !file.empty()) {
    const Journal journal = Journal::open(document.resolved(file));
    for (const Journal::Entry& entry : journal.strokes()) out.push_back({entry.stroke, entry.muted});
  }
  return out;
}

/// What a build has come to.
struct Builder::Stage {
  const Document& document;
  const SlotSource& slots;
  BuiltScene scene;
  Built built;
  field::NodePtr domain;
  Digest below;  ///< of all that the next layer may look at
};

Built Builder::build(const Document& document, const SlotSource& slots, Progress& progress) {
  check(document, "the scene");
  Stage stage{document, slots, {}, {}, {}, {}};
  stage.scene.document = document;
  stage.scene.settings = field_settings(document.terrain);
  make_ground(stage, progress);
  make_geology(stage);
  run_layers(stage, progress);
  BuiltScene& scene = stage.scene;
  scene.solid = field::intersect({scene.open, stage.domain});
  for (const BuiltLayer& layer : stage.built.layers) scene.layers.push_back(layer.result);
  stage.built.scene = std::make_shared<BuiltScene>(std::move(scene));
  return std::move(stage.built);
}

void Builder::make_ground(Stage& stage, Progress& progress) {
  const Document& document = stage.document;
  BuiltScene& scene = stage.scene;
  Stopwatch watch;
  // What the raster depends on, without what only its field does.
  Document words;
  words.terrain = document.terrain;
  words.scene.seed = document.terrain.generator.empty() ? 0 : document.scene.seed;
  Digest field_words;
  field_words.add(std::string_view(to_text(words)));
  const TerrainSettings plain;
  TerrainSettings& t = words.terrain;
  t.influence = plain.influence, t.amplitude = plain.amplitude, t.depth = plain.depth;
  t.interpolation = plain.interpolation, t.distance = plain.distance, t.domain.clear();
  Digest raster_key;
  raster_key.add(std::string_view(to_text(words)));
  if (!t.source.empty()) raster_key.add(files_.of(document.resolved(t.source)));
  const std::shared_ptr<const raster::Raster> raster = rasters_.get(
      raster_key, [&] { return std::make_shared<raster::Raster>(read_terrain(document, progress)); });
  scene.seconds.emplace_back("read terrain", watch.seconds());
  scene.crs = raster->crs;
  scene.voxel = chosen_voxel(document, *raster, scene.settings.influence);
  if (document.scene.voxel <= 0 && !is_volume(document) && !document.layers.empty() &&
      scene.voxel > scene.settings.influence / 4)
    progress.warn(fmt::format(
        "the terrain is so large that the voxel was set to {:g} m, too coarse for landforms of a few metres; "
        "choose a part of it with --window (or window = […]), or a smaller voxel",
        scene.voxel));

  watch = {};
  Digest key = raster_key;
  key.add(field_words).add(scene.voxel);
  if (!document.terrain.domain.empty()) key.add(files_.of(document.resolved(document.terrain.domain)));
  const MadeTerrain& made = terrains_.get(key, [&] {
    terrain::TerrainOptions options;
    options.settings = scene.settings;
    options.depth = document.terrain.depth;
    if (!document.terrain.domain.empty())
      options.polygons = io::read_polygons(document.resolved(document.terrain.domain), scene.crs);
    MadeTerrain out{terrain::make_terrain(*raster, scene.voxel, options, progress), nullptr, nullptr};
    out.open = field::heightfield(out.terrain.heights, scene.settings);
    out.domain = terrain::domain_tree(out.terrain, scene.settings);
    return out;
  });
  scene.terrain = made.terrain;
  scene.open = made.open;
  stage.domain = made.domain;
  stage.built.ground = key;
  stage.below = key;
  scene.seconds.emplace_back("terrain", watch.seconds());
}

std::shared_ptr<const io::Volume> Builder::read_volume(const std::filesystem::path& file,
                                                       Progress& progress) {
  return volumes_.get(files_.of(file),
                      [&] { return std::make_shared<const io::Volume>(io::read_volume(file, progress)); });
}

raster::Raster Builder::read_terrain(const Document& document, Progress& progress) {
  const TerrainSettings& t = document.terrain;
  if (t.generator.empty() && !is_volume(document)) return read_elevations(document, progress);
  if (!t.window.empty())
    fail(ErrorKind::input, "{}: a volume is taken as a whole; leave out the window", t.source);
  const raster::Raster made =
      t.generator.empty()
          ? heights_of(*read_volume(document.resolved(t.source), progress))
          : terrain::find_generator(t.generator)
                .generate(t.values, static_cast<std::uint64_t>(document.scene.seed), progress);
  return t.resolution > 0 ? raster::at_resolution(made, t.resolution, progress) : made;
}

void Builder::make_geology(Stage& stage) {
  Document words;
  words.geology = stage.document.geology;
  words.scene.seed = stage.document.scene.seed;
  const Vec3d origin = stage.scene.terrain.origin;
  Digest key;
  key.add(std::string_view(to_text(words))).add(origin.x).add(origin.y).add(origin.z);
  stage.scene.geology = geologies_.get(key, [&] { return geology_of(stage.document, origin); });
  stage.below.add(key);
}

/// Where a layer may act; null when it is not limited.
std::shared_ptr<const landforms::Region> Builder::region_of(Stage& stage, const Layer& layer,
                                                            Digest& digest) {
  const LayerSettings& s = layer.settings;
  const BuiltScene& scene = stage.scene;
  const Vec3d o = scene.terrain.origin;
  if (s.altitude.empty() && s.box.empty() && s.region.empty() && s.mask.empty()) return nullptr;
  for (const double v : s.altitude) digest.add(v);
  digest.add(std::uint64_t{s.altitude.size()});
  for (const double v : s.box) digest.add(v);
  digest.add(o.x).add(o.y).add(o.z).add(std::string_view(scene.crs));
  digest.add(std::string_view(s.region)).add(std::string_view(s.mask));
  if (!s.region.empty()) digest.add(files_.of(scene.document.resolved(s.region)));
  const std::string_view painting = painted_mask(layer);
  std::vector<Slot> strokes;
  if (!painting.empty()) {
    for (const Layer& other : scene.document.layers) {
      if (other.type != sculpt_layer || !other.settings.enabled) continue;
      const auto more = stage.slots(scene.document, other);
      strokes.insert(strokes.end(), more.begin(), more.end());
    }
    digest.add(painted_digest(strokes, painting)).add(stage.built.ground);
  } else if (!s.mask.empty()) {
    digest.add(files_.of(scene.document.resolved(s.mask)));
  }
  return regions_.get(digest, [&] {
    auto region = std::make_shared<landforms::Region>();
    if (!s.altitude.empty()) region->limit_altitude(s.altitude[0] - o.z, s.altitude[1] - o.z);
    if (!s.box.empty())
      region->limit_box({Vec3d{s.box[0], s.box[1], s.box[2]} - o, Vec3d{s.box[3], s.box[4], s.box[5]} - o});
    if (!s.region.empty())
      region->limit_polygon(to_local(io::read_polygons(scene.document.resolved(s.region), scene.crs), o));
    if (!painting.empty()) {
      region->limit_mask(
          std::make_shared<raster::Raster>(painted(strokes, painting, *scene.terrain.heights, o)));
    } else if (!s.mask.empty()) {
      io::DemOptions options;
      options.fill_distance = 0;
      options.crs = scene.crs;
      auto mask =
          std::make_shared<raster::Raster>(io::read_dem(scene.document.resolved(s.mask), options).raster);
      mask->placement.west -= o.x;
      mask->placement.north -= o.y;
      region->limit_mask(std::move(mask));
    }
    return std::shared_ptr<const landforms::Region>(std::move(region));
  });
}

BuiltLayer Builder::sculpt(Stage& stage, const Layer& layer, std::uint64_t seed) {
  const Stopwatch watch;
  const auto before = cook_.groups_cooked;
  SculptFrame frame;
  frame.origin = stage.scene.terrain.origin;
  frame.amplitude = stage.scene.settings.amplitude;
  frame.seed = seed;
  const auto region = region_of(stage, layer, frame.region_digest);
  frame.region = region.get();
  BuiltLayer out;
  out.sculpted = cook_.cook(stage.slots(stage.document, layer), frame);
  out.result.reused = cook_.groups_cooked == before;
  const bool settle = flag_value(layer, "settle", true);
  out.frame.add(frame.origin.x).add(frame.origin.y).add(frame.origin.z).add(frame.amplitude);
  out.frame.add(seed)
      .add(frame.region_digest)
      .add(std::uint64_t{settle})
      .add(std::uint64_t{out.sculpted->node != nullptr});
  out.key = Digest(out.frame).add(out.sculpted->digest);
  if (out.sculpted->node) {
    out.result.made.nodes = {out.sculpted->node};
    const auto limit = static_cast<float>(frame.amplitude);
    if (settle)
      out.result.made.reshape = [limit](field::NodePtr below) {
        return field::intersect(
            {field::unite({std::move(below), field::constant(-limit)}), field::constant(limit)});
      };
  }
  std::int64_t strokes = 0, muted = 0;
  for (const auto& group : out.sculpted->groups)
    for (const Slot& slot : group->slots) ++(slot.muted ? muted : strokes);
  out.result.made.report = {{"strokes", strokes}, {"muted", muted}};
  if (settle && out.sculpted->node) out.result.made.reshaped = everywhere;
  out.result.seconds = watch.seconds();
  return out;
}

BuiltLayer Builder::run_layer(Stage& stage, std::size_t index, Progress& progress) {
  const Layer& layer = stage.document.layers[index];
  const BuiltScene& scene = stage.scene;
  const std::uint64_t seed = layer_seed(stage.document, index);
  BuiltLayer out;
  if (layer.type == sculpt_layer) {
    out = sculpt(stage, layer, seed);
  } else {
    const Stopwatch watch;
    const Vec3d o = scene.terrain.origin;
    Digest region_digest;
    const auto region = region_of(stage, layer, region_digest);
    out.key = Digest(stage.below).add(digest_of(layer)).add(seed).add(region_digest);
    for (const std::string& path : paths_of(layer)) out.key.add(files_.of(stage.document.resolved(path)));
    if (const LayerResult* found = results_.find(out.key)) {
      out.result = *found;
      out.result.reused = true;
    } else if (layer.type == primitives_layer) {
      out.result.made.nodes = read_primitives(layer, seed, scene, region.get());
    } else if (layer.type == volume_layer) {
      VolumeSettings settings;
      assign(volume_params(), &settings, layer.values, "volume");
      const auto volume = read_volume(scene.document.resolved(settings.file), progress);
      out.result.made = place_volume(*volume, settings, o, scene.settings.amplitude);
    } else {
      landforms::Site site;
      site.origin = o;
      site.heights = scene.terrain.heights;
      site.valid = scene.terrain.valid.get();
      site.influence = scene.settings.influence;
      site.amplitude = scene.settings.amplitude;
      // Without the domain, whose walls are no cliffs.
      site.terrain = scene.open;
      site.geology = scene.geology;
      site.region = region.get();
      if (!layer.settings.points.empty()) {
        const auto file = scene.document.resolved(layer.settings.points);
        for (Vec3d p : io::parse_points_csv(io::read_text(file), file.string())) site.points.push_back(p - o);
      }
      site.seed = seed;
      out.result.made = landforms::find_landform(layer.type).generate(site, layer.values, progress);
    }
    out.result.seconds = watch.seconds();
    if (!out.result.reused) results_.put(out.key, out.result);
  }
  out.result.type = layer.type;
  out.result.name = shown_name(layer);
  return out;
}

void Builder::run_layers(Stage& stage, Progress& progress) {
  for (std::size_t i = 0; i < stage.document.layers.size(); ++i) {
    const Layer& layer = stage.document.layers[i];
    if (!layer.settings.enabled) continue;
    try {
      stage.built.layers.push_back(run_layer(stage, i, progress));
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::cancelled) throw;
      std::string_view what = error.what();
      if (const std::string type = layer.type + ": "; what.starts_with(type)) what.remove_prefix(type.size());
      // What a file says is input, however it came to be wrong.
      const bool read = layer.line > 0 && error.kind() == ErrorKind::usage;
      fail(read ? ErrorKind::input : error.kind(), "{}layer {}: {}", place_of(stage.document, layer),
           shown_name(layer), what);
    }
    const BuiltLayer& made = stage.built.layers.back();
    stage.scene.open = landforms::applied(stage.scene.open, made.result.made);
    stage.scene.seconds.emplace_back(made.result.name, made.result.seconds);
    stage.below.add(made.key);
  }
}

namespace {

void add_support(const BuiltLayer& layer, std::vector<Box3d>& out) {
  if (layer.sculpted) changed_boxes(nullptr, layer.sculpted.get(), out);
  if (!layer.result.made.reshaped.empty()) out.push_back(layer.result.made.reshaped);
  if (!layer.sculpted)
    for (const field::NodePtr& node : layer.result.made.nodes) out.push_back(field::support(node));
}

/// Whether two layers at the same place may stay, with the boxes in which they differ.
bool alike(const BuiltLayer& before, const BuiltLayer& now, std::vector<Box3d>& out) {
  if (before.key == now.key) return true;
  if (!before.sculpted || !now.sculpted || before.frame != now.frame) return false;
  changed_boxes(before.sculpted.get(), now.sculpted.get(), out);
  return true;
}

}  // namespace

std::vector<Box3d> changed_boxes(const Built& before, const Built& now) {
  if (before.ground != now.ground) return {everywhere};
  std::vector<Box3d> out;
  const auto &a = before.layers, &b = now.layers;
  std::size_t first = 0;
  while (first < a.size() && first < b.size() && alike(a[first], b[first], out)) ++first;
  std::size_t same = 0;
  while (same < a.size() - first && same < b.size() - first &&
         alike(a[a.size() - 1 - same], b[b.size() - 1 - same], out))
    ++same;
  for (std::size_t i = first; i < a.size() - same; ++i) add_support(a[i], out);
  for (std::size_t i = first; i < b.size() - same; ++i) add_support(b[i], out);
  std::erase_if(out, [](const Box3d& box) { return box.empty(); });
  return out;
}

}  // namespace tafoni::scene::impl
