// Elevations come from a file by GDAL, from a volume's upper surface or from a generator; the terrain and its
// field are made of them on the scene's lattice, the geology from the tree of its kinds.
#include "tafoni/scene/build/impl/ground.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/geology/kind.h"
#include "tafoni/io/dem.h"
#include "tafoni/io/format.h"
#include "tafoni/io/vector.h"
#include "tafoni/raster/resample.h"
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

namespace impl {
namespace {

raster::Raster read_elevations(const TerrainSection& words, const File& source, Progress& progress) {
  io::DemOptions options;
  if (!words.window.empty()) {
    std::array<int, 4> window{};
    std::transform(words.window.begin(), words.window.end(), window.begin(),
                   [](double v) { return static_cast<int>(v); });
    options.window = window;
  }
  options.resolution = words.resolution;
  options.band = static_cast<int>(words.band);
  options.fill_distance = words.fill;
  options.smooth = words.smooth;
  options.pixel_size = words.pixel_size;
  options.height_scale = words.height_scale;
  return io::read_dem(source.path, options, progress).raster;
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
  if (source && !volume) return std::make_shared<raster::Raster>(read_elevations(words, *source, progress));
  if (!words.window.empty())
    fail(ErrorKind::input, "{}: a volume is taken as a whole; leave out the window", words.source);
  raster::Raster made = volume
                            ? heights_of(*readers.volume(*source))
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
