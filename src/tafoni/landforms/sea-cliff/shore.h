#pragma once
// Where the sea reaches: how far places are from open water, and how sheltered they lie.

#include <cstdint>

#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

struct ShoreSettings {
  double reach = 40;                 ///< metres from the shoreline, on land and off it
  double accessibility = 0.5;        ///< how much sheltered places are spared, in [0, 1]
  double accessibility_radius = 20;  ///< metres of open space before a place that is fully exposed
};

class Shore {
 public:
  /// `sea_z` is the local z of the sea level.
  Shore(const Ground& ground, const ShoreSettings& settings, double sea_z, Progress& progress);

  /// How strongly the sea acts at a place for its distance alone: 1 near the shoreline, 0 beyond its reach.
  double nearness(Vec3d p) const;
  /// How freely waves come to a place: 1 in the open, less in sheltered places.
  double accessibility(Vec3d p) const;
  /// False only where nothing within `around` metres of p is near the sea.
  bool may_reach(Vec3d p, double around) const;

 private:
  raster::Raster water_distance(double sea_z, Progress& progress) const;
  raster::Raster exposure(Progress& progress) const;
  raster::Grid<std::uint8_t> strip(int more) const;

  const Ground& ground_;
  ShoreSettings s_;
  raster::Raster water_;  ///< empty when there is no water, and then the sea acts everywhere
  raster::Raster open_;   ///< empty where shelter does not count
};

}  // namespace tafoni::landforms::impl
