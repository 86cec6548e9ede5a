#pragma once
// An elevation model as a field: choice of the origin, the domain, and its construction tree.

#include <cstdint>
#include <memory>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/vec.h"
#include "tafoni/raster/grid.h"

namespace tafoni::terrain {

/// A terrain in the local frame: world minus origin. All parts agree with one another.
struct Terrain {
  /// World position of local (0, 0, 0): whole multiples of the voxel size near the middle of the raster, so
  /// that every window of a DEM shares one lattice and local floats stay small.
  Vec3d origin;
  std::shared_ptr<const raster::Raster> heights;  ///< local metres, finite everywhere
  /// Signed distance in metres to the border of the domain, positive inside; null when the domain is the
  /// whole rectangle. The border of missing data is smoothed over about two pixels, and islets of data less
  /// than about eight pixels wide are left out.
  std::shared_ptr<const raster::Raster> inside;
  /// 1 where the domain's heights are data or mended small holes, 0 outside; null when 1 everywhere.
  std::shared_ptr<const raster::Grid<std::uint8_t>> valid;
  /// Local. x and y: the outer border of the outermost pixels, as a value stands for the whole of its pixel.
  /// lo.z: the base, a whole multiple of the voxel size at least R below the lowest height. hi.z: at least
  /// R above the highest.
  Box3d box;

  Vec3d to_local(Vec3d world) const { return world - origin; }
  Vec3d to_world(Vec3d local) const { return local + origin; }
};

struct TerrainOptions {
  field::HeightfieldSettings settings;
  double depth = 0;  ///< metres of rock below the lowest height beyond the R that is always there
  /// World coordinates, even-odd rule; empty: no limit beyond the data's own.
  std::vector<std::vector<Vec2d>> polygons;
};

/// `world`: metres, NaN outside the domain. Throws Error{input} when nothing is left of the domain, and
/// Error{usage} when R > 3T.
Terrain make_terrain(const raster::Raster& world, double voxel, const TerrainOptions& options = {},
                     Progress& progress = silent());

/// f_P: the prism of the terrain's domain.
field::NodePtr domain_tree(const Terrain& terrain, const field::HeightfieldSettings& settings);
/// min(f_T, f_P).
field::NodePtr terrain_tree(const Terrain& terrain, const field::HeightfieldSettings& settings);

}  // namespace tafoni::terrain
