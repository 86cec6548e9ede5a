#pragma once
// Where pillars of rock stand: Poisson-disk places of medium slope and little drainage [Paris19 §6.3].

#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

struct StandSettings {
  double spacing = 10;                    ///< metres: none are nearer
  double across = 4;                      ///< metres over which a slope is taken
  double margin = 5;                      ///< metres kept to missing data and the raster's outline
  double density = 1;                     ///< share of the possible places that is taken
  double slope_from = 15, slope_to = 60;  ///< degrees
  double ridges = 0;                      ///< in [0, 1]: how far they keep to crests
  double clusters = 0;                    ///< in [0, 1]: how far they gather in groups
  double catchment = 60;                  ///< metres: drainage area per metre of contour
  double river = 0;                       ///< metres to the nearest river; 0: anywhere
  double river_area = 1e5;                ///< m^2 that make a river
  std::size_t most = 1000;
  std::uint64_t seed = 0;
};

/// Drainage and rivers of a site, and how likely a pillar is at a place.
class Stands {
 public:
  Stands(const Ground& ground, const StandSettings& settings, Progress& progress);
  /// In [0, 1]: 0 where none may stand.
  double chance(double x, double y) const;
  /// Places on the ground, none nearer to another, or to one of `taken`, than the spacing. Every place of a
  /// dense Poisson-disk set is kept with its chance.
  std::vector<Vec3d> places(const std::vector<Vec3d>& taken) const;
  /// rise over run, over `across` metres
  double slope(double x, double y) const;

 private:
  const Ground& ground_;
  StandSettings settings_;
  raster::Grid<float> catchment_;  ///< metres
  raster::Grid<float> river_;      ///< metres to the nearest; empty where rivers do not matter
};

}  // namespace tafoni::landforms::impl
