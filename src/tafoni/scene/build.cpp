#include "tafoni/scene/build.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/geology/kind.h"
#include "tafoni/io/dem.h"
#include "tafoni/io/vector.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/raster/resample.h"
#include "tafoni/scene/csv.h"
#include "tafoni/scene/impl/primitives_layer.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::scene {
namespace {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

field::TerrainSettings field_settings(const TerrainSettings& t) {
  return {t.influence, t.amplitude, t.interpolation == "bicubic", t.distance == "first-order"};
}

raster::Raster read_terrain(const Document& document, Progress& progress) {
  const TerrainSettings& t = document.terrain;
  if (!t.generator.empty()) {
    raster::Raster made = terrain::find_generator(t.generator)
                              .generate(t.values, static_cast<std::uint64_t>(document.scene.seed), progress);
    return t.resolution > 0 ? raster::at_resolution(made, t.resolution, progress) : made;
  }
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

/// The geologies of a list, each with a seed of its place.
std::vector<geology::GeologyPtr> make_geologies(const std::vector<GeologySettings>& list, Vec3d origin,
                                                std::uint64_t seed) {
  std::vector<geology::GeologyPtr> out;
  for (const GeologySettings& g : list) {
    const auto own = g.seed >= 0 ? static_cast<std::uint64_t>(g.seed) : hash_combine(seed, out.size());
    out.push_back(geology::make_geology(g.type, g.values, make_geologies(g.of, origin, own), origin, own));
  }
  return out;
}

geology::GeologyPtr make_geology(const Document& document, Vec3d origin) {
  const auto seed = static_cast<std::uint64_t>(document.scene.seed);
  if (document.geology.empty()) return geology::default_geology(origin, seed);
  auto parts = make_geologies(document.geology, origin, seed);
  if (parts.size() == 1) return parts.front();
  return geology::make_geology("blend", {}, std::move(parts), origin, seed);
}

std::vector<landforms::Ring> to_local(std::vector<landforms::Ring> rings, Vec3d origin) {
  for (auto& ring : rings)
    for (Vec2d& p : ring) p = p - Vec2d{origin.x, origin.y};
  return rings;
}

/// Where a layer may act; empty when it is not limited.
std::optional<landforms::Region> region_of(const Layer& layer, const BuiltScene& scene) {
  const LayerSettings& s = layer.settings;
  const Vec3d o = scene.terrain.origin;
  if (s.altitude.empty() && s.box.empty() && s.region.empty() && s.mask.empty()) return {};
  landforms::Region region;
  if (!s.altitude.empty()) region.limit_altitude(s.altitude[0] - o.z, s.altitude[1] - o.z);
  if (!s.box.empty())
    region.limit_box({Vec3d{s.box[0], s.box[1], s.box[2]} - o, Vec3d{s.box[3], s.box[4], s.box[5]} - o});
  if (!s.region.empty())
    region.limit_polygon(to_local(io::read_polygons(scene.document.resolved(s.region), scene.crs), o));
  if (!s.mask.empty()) {
    io::DemOptions options;
    options.fill_distance = 0;
    options.crs = scene.crs;
    auto mask =
        std::make_shared<raster::Raster>(io::read_dem(scene.document.resolved(s.mask), options).raster);
    mask->placement.west -= o.x;
    mask->placement.north -= o.y;
    region.limit_mask(std::move(mask));
  }
  return region;
}

std::vector<field::NodePtr> read_primitives(const Layer& layer, std::uint64_t seed, const BuiltScene& scene,
                                            const landforms::Region* region) {
  impl::PrimitivesSettings settings;
  assign(impl::primitives_params(), &settings, layer.values, "primitives");
  const auto file = scene.document.resolved(settings.file);
  std::function<bool(Vec3d)> keep;
  if (region) keep = [region](Vec3d p) { return region->contains(p); };
  return impl::make_primitives(read_text(file), file.string(), settings, scene.terrain.origin,
                               scene.settings.influence, seed, keep);
}

LayerResult run_layer(const Layer& layer, std::uint64_t seed, const BuiltScene& scene, Progress& progress) {
  const Stopwatch watch;
  LayerResult result;
  result.type = layer.type;
  result.name = layer.settings.name.empty() ? layer.type : layer.settings.name;
  const auto region = region_of(layer, scene);
  const Vec3d o = scene.terrain.origin;
  if (layer.type == primitives_layer) {
    result.made.nodes = read_primitives(layer, seed, scene, region ? &*region : nullptr);
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
    site.region = region ? &*region : nullptr;
    if (!layer.settings.points.empty()) {
      const auto file = scene.document.resolved(layer.settings.points);
      for (Vec3d p : parse_points_csv(read_text(file), file.string())) site.points.push_back(p - o);
    }
    site.seed = seed;
    result.made = landforms::find_landform(layer.type).generate(site, layer.values, progress);
  }
  result.seconds = watch.seconds();
  return result;
}

void run_layers(BuiltScene& scene, Progress& progress) {
  for (std::size_t i = 0; i < scene.document.layers.size(); ++i) {
    const Layer& layer = scene.document.layers[i];
    if (!layer.settings.enabled) continue;
    try {
      scene.layers.push_back(run_layer(layer, layer_seed(scene.document, i), scene, progress));
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::cancelled) throw;
      const std::string& name = layer.settings.name.empty() ? layer.type : layer.settings.name;
      fail(error.kind(), "layer {}: {}", name, error.what());
    }
    scene.open = landforms::applied(scene.open, scene.layers.back().made);
    scene.seconds.emplace_back(scene.layers.back().name, scene.layers.back().seconds);
  }
}

}  // namespace

double default_voxel(const raster::Raster& raster, double influence) {
  const double pixel = std::min(raster.placement.dx, raster.placement.dy);
  const double extent = std::max(raster.placement.dx * raster.width(), raster.placement.dy * raster.height());
  const double wanted = std::max(std::min(pixel, influence / 10), extent / 1200);
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  double best = decade;
  for (double digit : {2.0, 2.5, 5.0, 10.0})
    if (std::abs(std::log(decade * digit / wanted)) < std::abs(std::log(best / wanted)))
      best = decade * digit;
  return best;
}

std::uint64_t layer_seed(const Document& document, std::size_t index) {
  const Layer& layer = document.layers[index];
  if (layer.settings.seed >= 0) return static_cast<std::uint64_t>(layer.settings.seed);
  std::uint64_t seed = static_cast<std::uint64_t>(document.scene.seed);
  for (const std::string* word : {&layer.type, &layer.settings.name}) {
    for (const char c : *word) seed = hash_combine(seed, static_cast<unsigned char>(c));
    seed = hash_combine(seed, word->size());
  }
  const auto alike = [&](const Layer& other) {
    return other.type == layer.type && other.settings.name == layer.settings.name;
  };
  const auto begin = document.layers.begin();
  return hash_combine(seed, static_cast<std::uint64_t>(
                                std::count_if(begin, begin + static_cast<std::ptrdiff_t>(index), alike)));
}

std::optional<double> sea_level(const Document& document) {
  for (const Layer& layer : document.layers) {
    if (!layer.settings.enabled) continue;
    for (const ParamInfo& info : params_of_layer(layer.type)) {
      if (info.name != "sea_level" || info.kind != ValueKind::real) continue;
      const auto found = layer.values.find(info.name);
      return std::get<double>(found == layer.values.end() ? info.init : found->second);
    }
  }
  return {};
}

BuiltScene build(const Document& document, Progress& progress) {
  check(document, "the scene");
  BuiltScene scene;
  scene.document = document;
  scene.settings = field_settings(document.terrain);

  Stopwatch watch;
  const raster::Raster raster = read_terrain(document, progress);
  scene.seconds.emplace_back("read terrain", watch.seconds());
  scene.crs = raster.crs;
  scene.voxel =
      document.scene.voxel > 0 ? document.scene.voxel : default_voxel(raster, scene.settings.influence);
  if (document.scene.voxel <= 0 && !document.layers.empty() && scene.voxel > scene.settings.influence / 4)
    progress.warn(fmt::format(
        "the terrain is so large that the voxel was set to {:g} m, too coarse for landforms of a few metres; "
        "choose a part of it with --window (or window = […]), or a smaller voxel",
        scene.voxel));

  watch = {};
  terrain::TerrainOptions options;
  options.settings = scene.settings;
  options.depth = document.terrain.depth;
  if (!document.terrain.domain.empty())
    options.polygons = io::read_polygons(document.resolved(document.terrain.domain), scene.crs);
  scene.terrain = terrain::make_terrain(raster, scene.voxel, options, progress);
  scene.open = field::heightfield(scene.terrain.heights, scene.settings);
  scene.geology = make_geology(document, scene.terrain.origin);
  scene.seconds.emplace_back("terrain", watch.seconds());

  run_layers(scene, progress);
  scene.solid =
      field::combine("intersection", {scene.open, terrain::domain_tree(scene.terrain, scene.settings)});
  return scene;
}

std::string_view version() {
  return TAFONI_VERSION;
}

}  // namespace tafoni::scene
