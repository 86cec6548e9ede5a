// What a document leaves open is chosen here: the voxel from the terrain, a layer's seed from its words and
// place, the sea level from the layer that has one. The build itself is the Builder's.
#include "tafoni/scene/build/build.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/scene/build/impl/builder.h"
#include "tafoni/scene/sculpt/impl/stroke_files.h"

namespace tafoni::scene {
namespace {

// Chosen by eye: a voxel resolves every pixel and a tenth of the influence, within which landforms shape the
// rock, but makes no more cells along the terrain than a mesh of a few million triangles has, nor more than a
// few within a pixel, where there is nothing to be seen between them.
constexpr double cells_per_influence = 10, most_cells = 1200, most_cells_per_pixel = 3;
// No ground is so steep that its mesh would have more at that. Heights in a wrong unit, or over pixels of a
// wrong size, are, and would ask for hundreds of millions.
constexpr double most_triangles = 12e6;
// Pixels from which the area of a surface is judged.
constexpr double judged_pixels = 4e6;

/// m² of a raster's surface.
double surface_area(const raster::Raster& raster) {
  const double dx = raster.placement.dx, dy = raster.placement.dy;
  const int step = std::max(1, static_cast<int>(1.0 * raster.width() * raster.height() / judged_pixels));
  double area = 0;
  for (int row = 0; row + 1 < raster.height(); row += step)
    for (int col = 0; col + 1 < raster.width(); ++col) {
      const double here = raster.values.at(col, row);
      const double east = (raster.values.at(col + 1, row) - here) / dx;
      const double south = (raster.values.at(col, row + 1) - here) / dy;
      const double steepness = std::sqrt(1 + east * east + south * south);
      if (!std::isnan(steepness)) area += steepness;
    }
  return area * dx * dy * step;
}

}  // namespace

double default_voxel(const raster::Raster& raster, double influence) {
  const double pixel = std::min(raster.placement.dx, raster.placement.dy);
  const double extent = std::max(raster.placement.dx * raster.width(), raster.placement.dy * raster.height());
  const double least = pixel / most_cells_per_pixel;
  const double wanted = std::max({std::min(pixel, influence / cells_per_influence), extent / most_cells,
                                  least, std::sqrt(2 * surface_area(raster) / most_triangles)});
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  double best = 10 * decade;
  for (double digit : {5.0, 2.5, 2.0, 1.0})
    if (decade * digit >= least &&
        std::abs(std::log(decade * digit / wanted)) <= std::abs(std::log(best / wanted)))
      best = decade * digit;
  return best;
}

std::uint64_t layer_seed(const Document& document, std::size_t index) {
  const Layer& layer = document.layers[index];
  if (layer.settings.seed >= 0) return layer.settings.seed;
  std::uint64_t seed = document.scene.seed;
  for (const std::string* word : {&layer.type, &layer.settings.name}) {
    for (const char c : *word) seed = hash_combine(seed, static_cast<unsigned char>(c));
    seed = hash_combine(seed, word->size());
  }
  const auto alike = [&](const Layer& other) {
    return other.type == layer.type && other.settings.name == layer.settings.name;
  };
  const auto begin = document.layers.begin();
  return hash_combine(seed, static_cast<std::uint64_t>(std::count_if(begin, begin + index, alike)));
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
  const auto slots = [&](const Document& d, const Layer& layer) {
    return impl::slots_of(d, layer, progress);
  };
  return *impl::Builder().build(document, slots, progress).scene;
}

std::string_view version() {
  return TAFONI_VERSION;
}

}  // namespace tafoni::scene
