#pragma once
// Where pillars of rock stand: Poisson-disk places of medium slope and little drainage [Paris19 §6.3].

#include <cstdint>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// Parameters of hoodoos.
struct StandSettings {
  double spacing = 0;                    ///< metres: none are nearer; 0: by the pillars' radius
  double density = 1;                    ///< share of the possible places that is taken
  std::int64_t count = 2000;             ///< most
  std::vector<double> slope = {14, 60};  ///< degrees: least and greatest
  double ridges = 0.5;                   ///< in [0, 1]: how far they keep to crests
  double clusters = 0.5;                 ///< in [0, 1]: how far they gather in groups
  double catchment = 0;                  ///< metres: drainage area per metre of contour; 0: by the terrain
  double river = 0;                      ///< metres to the nearest river; 0: anywhere
  double river_area = 20000;             ///< m^2 that make a river
};

/// Drainage and rivers of a site, and how likely a pillar is at a place.
class Stands {
 public:
  /// For pillars of `radius` metres.
  Stands(const Ground& ground, const StandSettings& settings, double radius, Progress& progress);
  /// In [0, 1]: 0 where none may stand.
  double chance(double x, double y) const;
  /// Places on the ground, none nearer to another, or to one of `taken`, than the spacing. Every place of a
  /// dense Poisson-disk set is kept with its chance.
  std::vector<Vec3d> places(const std::vector<Vec3d>& taken) const;

 private:
  double slope(double x, double y) const;
  double chance_by_relief(Vec3d p) const;
  double share_by_gullies(Vec2d pixel) const;
  double share_by_river(Vec2d pixel) const;

  const Ground& ground_;
  StandSettings settings_;  ///< with what is 0 filled in
  double across_, margin_;  ///< metres: over which a slope is taken; kept to missing data and to the outline
  std::uint64_t seed_;
  raster::Grid<float> catchment_;  ///< metres
  raster::Grid<float> river_;      ///< metres to the nearest; empty where rivers do not matter
};

}  // namespace tafoni::landforms::impl
