#pragma once
// How deep a scene's base lies: below what layers carve or build, wherever that is below the terrain's own.

#include "tafoni/core/progress.h"
#include "tafoni/field/tree.h"
#include "tafoni/terrain/terrain.h"

namespace tafoni::scene::impl {

/// The base follows what lies so far below that of the terrain at most, in metres; the deepest caves known go
/// down 2.2 km.
inline constexpr double deepest_base = 5000;

/// What the search for the surface below the terrain's base goes by.
struct BaseSearch {
  const terrain::Terrain& terrain;
  field::NodePtr open;  ///< f_T and the layers
  double lowest = 0;    ///< local z below which no layer moved the surface; minus infinity where unknown
  double voxel = 1;
  double influence = 15;
};

/// Local z of the base, a whole multiple of the voxel: the terrain's own, or at least R below the lowest
/// place of the surface that lies below that within the domain. Warns of what lies too deep to follow.
double base_of(const BaseSearch& search, Progress& progress);

}  // namespace tafoni::scene::impl
