#pragma once
// Analysis of elevation models. Grids have the raster's size; a cell whose height is NaN lies outside the
// terrain and is NaN in every result. Nothing here depends on the number of threads. Memory is proportional
// to the grid.

#include <cstdint>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/raster/grid.h"

namespace tafoni::terrain {

/// |grad h|, rise over run, from central differences (one-sided beside a border or a missing cell).
raster::Grid<float> slope(const raster::Raster& heights, Progress& progress = silent());

struct FillSettings {
  /// Also gives every filled or flat cell a strictly lower neighbour, in steps of a
  /// micrometre or, where floats are coarser, one unit in the last place.
  bool drain_flats = true;
};
/// Fills depressions by Priority-Flood [Barnes14]: the lowest surface >= heights from
/// which every cell drains, over its 8 neighbours, to the border of the grid or to a missing cell.
raster::Grid<float> fill_depressions(const raster::Raster& heights, const FillSettings& settings = {},
                                     Progress& progress = silent());

/// Upslope area in m^2, the cell's own included, by multiple flow directions [Freeman91]: a cell's area
/// goes to its lower neighbours in proportion to slope^exponent. Area stops at a cell without a lower
/// neighbour, so give the surface fill_depressions() made.
raster::Grid<float> drainage_area(const raster::Raster& filled, double exponent = 1.1,
                                  Progress& progress = silent());

/// A^(1/2) s of each cell [Paris19 §6.1], [Whipple99].
raster::Grid<float> stream_power(const raster::Grid<float>& area, const raster::Grid<float>& slope);

struct AccessibilitySettings {
  double max_radius = 20;  ///< metres: a cell that a sphere of this radius can touch is wholly open
  /// Cells where the result is wanted (1); the others are NaN. Null: all.
  const raster::Grid<std::uint8_t>* wanted = nullptr;
};
/// Local accessibility [Miller94] of a heightfield in [0, 1]: the radius of the largest sphere that
/// touches the surface at the cell, tangent to it and above, without cutting the terrain, over max_radius.
/// The terrain is the columns below the cells' centres, so what lies between centres is not seen; over these
/// columns the radius is exact.
raster::Grid<float> accessibility(const raster::Raster& heights, const AccessibilitySettings& settings = {},
                                  Progress& progress = silent());

/// A closed depression of the terrain.
struct Sink {
  int col = 0, row = 0;  ///< the deepest cell, the first in row order among equals
  double elevation = 0;  ///< of the deepest cell
  double spill = 0;      ///< elevation at which water leaves it
  double area = 0;       ///< m^2 below the spill
  double volume = 0;     ///< m^3 below the spill
  double depth() const { return spill - elevation; }
};
struct SinkSettings {
  double min_depth = 0.0;  ///< metres; shallower ones are left out
  double min_area = 0.0;   ///< m^2; smaller ones are left out
};
/// Every depression, one sink each: an 8-connected set of cells below the filled surface. Ordered by row,
/// then column of the deepest cell.
std::vector<Sink> sinks(const raster::Raster& heights, const SinkSettings& settings = {},
                        Progress& progress = silent());

}  // namespace tafoni::terrain
