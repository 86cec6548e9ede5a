#pragma once
// Built-in generators of elevation models: terrain to start from when there is no DEM at hand.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/core/registry.h"
#include "tafoni/raster/grid.h"

namespace tafoni::terrain {

/// What every generator takes besides its own parameters; derive from it and call add_grid_params().
struct GridSettings {
  std::int64_t width = 600, height = 450;  ///< pixels
  double pixel = 1.0;                      ///< metres

  int columns() const { return static_cast<int>(width); }
  int rows() const { return static_cast<int>(height); }
  /// Metres from west to east and from south to north.
  Vec2d extent() const { return {columns() * pixel, rows() * pixel}; }
};

template <class P>
void add_grid_params(ParamTable<P>& table) {
  table.integer("width", static_cast<std::int64_t P::*>(&GridSettings::width), "px", 2, 32768,
                "Columns of the elevation model");
  table.integer("height", static_cast<std::int64_t P::*>(&GridSettings::height), "px", 2, 32768,
                "Rows of the elevation model");
  table.real("pixel", static_cast<double P::*>(&GridSettings::pixel), "m", 0.05, 1000,
             "Side of a pixel; the map is width and height of them");
}

struct GeneratorType {
  Declaration about = {};  ///< its parameters begin with width, height and pixel
  /// `values` hold only what differs from the defaults. The south-west corner lies at (0, 0); sea level is 0;
  /// every height is finite. The same values and seed give the same bytes at any thread count.
  raster::Raster (*generate)(const Values& values, std::uint64_t seed, Progress& progress) = nullptr;
};

/// Every generator, sorted by name; generators/NAME.cpp defines `const GeneratorType& declaration()` in its
/// namespace `generator_NAME`.
std::span<const GeneratorType* const> all_generators();
/// Throws Error{usage} naming the nearest known one.
const GeneratorType& find_generator(std::string_view name);

}  // namespace tafoni::terrain
