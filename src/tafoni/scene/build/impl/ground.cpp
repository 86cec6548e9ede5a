// Elevations come from a file by GDAL, from a volume's upper surface or from a generator; the terrain and its
// field are made of them on the scene's lattice, the geology from the tree of its kinds.
#include "tafoni/scene/build/impl/ground.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/geology/kind.h"
#include "tafoni/io/dem.h"
#include "tafoni/io/format.h"
#include "tafoni/io/vector.h"
#include "tafoni/raster/resample.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/build/impl/volume_heights.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::scene {
namespace {

/// A document that says nothing else reads as these words alone.
void add_text(impl::Digest& to, const Document& words) {
  to.add(std::string_view(to_text(words)));
}

}  // namespace

void add_part(impl::Digest& to, const TerrainSection& words) {
  Document alone;
  alone.terrain = words;
  add_text(to, alone);
}

void add_part(impl::Digest& to, const GeologySettings& words) {
  Document alone;
  alone.geology = {words};
  add_text(to, alone);
}

void add_part(impl::Digest& to, const Layer& words) {
  Document alone;
  alone.layers = {words};
  add_text(to, alone);
}

io::DemOptions dem_options(const TerrainSection& words) {
  using Encoding = io::HeightEncoding;
  static const std::map<std::string_view, Encoding> encodings = {
      {"auto", Encoding::automatic},      {"heights", Encoding::heights},
      {"heightmap", Encoding::heightmap}, {"terrain-rgb", Encoding::terrain_rgb},
      {"mapbox", Encoding::terrain_rgb},  {"terrarium", Encoding::terrarium}};
  static const std::map<std::string_view, io::ByteOrder> orders = {
      {"auto", io::ByteOrder::automatic}, {"little", io::ByteOrder::little}, {"big", io::ByteOrder::big}};
  const auto pixels = [](const std::vector<double>& from, auto to) {
    std::transform(from.begin(), from.end(), to.begin(), [](double v) { return static_cast<int>(v); });
    return to;
  };
  io::DemOptions out;
  if (!words.window.empty()) out.window = pixels(words.window, std::array<int, 4>{});
  out.resolution = words.resolution;
  out.band = static_cast<int>(words.band);
  out.fill_distance = words.fill;
  out.smooth = words.smooth;
  out.pixel_size = words.pixel_size;
  out.encoding = encodings.at(words.encoding);
  out.height_scale = words.height_scale;
  out.height_offset = words.height_offset;
  out.raw_size = pixels(words.raw_size, out.raw_size);
  out.byte_order = orders.at(words.byte_order);
  out.own_crs = words.crs;
  return out;
}

namespace impl {
namespace {

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

}  // namespace

VolumePtr read_volume_file(const File& file, Progress& progress) {
  return std::make_shared<const io::Volume>(io::read_volume(file.path, progress));
}

bool is_volume(const TerrainSection& words) {
  return io::can(words.source, io::Ability::read_volume);
}

TerrainSection words_of_field(const TerrainSection& words) {
  TerrainSection out;
  out.influence = words.influence;
  out.amplitude = words.amplitude;
  out.interpolation = words.interpolation;
  out.distance = words.distance;
  out.depth = words.depth;
  return out;
}

TerrainSection words_of_elevations(const TerrainSection& words) {
  const TerrainSection plain;
  TerrainSection out = words;
  out.influence = plain.influence;
  out.amplitude = plain.amplitude;
  out.interpolation = plain.interpolation;
  out.distance = plain.distance;
  out.depth = plain.depth;
  out.domain.clear();
  return out;
}

RasterPtr make_elevations(const TerrainSection& words, const std::uint64_t& seed,
                          const std::optional<File>& source, Readers& readers) {
  Progress& progress = readers.progress;
  const bool volume = source && is_volume(words);
  if (source && !volume) {
    return std::make_shared<raster::Raster>(io::read_dem(source->path, dem_options(words), progress).raster);
  }
  if (!words.window.empty())
    fail(ErrorKind::input, "{}: a volume is taken as a whole; leave out the window", words.source);
  raster::Raster made = volume
                            ? heights_of(*readers.volume(*source), words.source)
                            : terrain::find_generator(words.generator).generate(words.values, seed, progress);
  if (words.resolution > 0) made = raster::at_resolution(made, words.resolution, progress);
  return std::make_shared<raster::Raster>(std::move(made));
}

Ground make_ground(const Keyed<RasterPtr>& elevations, const TerrainSection& words, const double& voxel,
                   const std::optional<File>& domain, Progress& progress) {
  Ground out;
  out.settings = {words.influence, words.amplitude, words.interpolation == "bicubic",
                  words.distance == "first-order"};
  terrain::TerrainOptions options;
  options.settings = out.settings;
  options.depth = words.depth;
  if (domain) options.polygons = io::read_polygons(domain->path, elevations.value->crs);
  out.terrain = terrain::make_terrain(*elevations.value, voxel, options, progress);
  out.open = field::heightfield(out.terrain.heights, out.settings);
  return out;
}

geology::GeologyPtr make_geology(const std::vector<GeologySettings>& words, const std::uint64_t& seed,
                                 const Vec3d& origin, Progress&) {
  if (words.empty()) return geology::default_geology(origin, seed);
  auto all = geologies_of(words, origin, seed);
  if (all.size() == 1) return all.front();
  return geology::make_geology("blend", {}, std::move(all), origin, seed);
}

}  // namespace impl
}  // namespace tafoni::scene
