#pragma once
// What a terrain starts from.

#include <filesystem>

#include "tafoni/core/progress.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::runtime::impl {

struct Ground {
  volume::ScalarGrid grid;
  Vec3d origin;  ///< world position of local zero
  surface::Boundary boundary = surface::Boundary::solid;
  double band = 0;  ///< greatest magnitude of a value
};

/// Each throws Error{usage} for settings that make no sense and for what takes more memory than they allow.
Ground ground_of(const scene::BuiltScene& scene, const DestructibleTerrainSettings& settings,
                 Progress& progress);
Ground ground_of(volume::ScalarGrid grid, Vec3d origin, const DestructibleTerrainSettings& settings);
/// A scene file or a volume file, by extension.
Ground read_ground(const std::filesystem::path& file, const DestructibleTerrainSettings& settings,
                   Progress& progress);

}  // namespace tafoni::runtime::impl
