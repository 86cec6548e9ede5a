#pragma once
// What a terrain starts from.

#include <filesystem>

#include "tafoni/core/progress.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/runtime/impl/history.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::runtime::impl {

struct Ground {
  volume::ScalarGrid grid;
  surface::Boundary boundary = surface::Boundary::solid;
  Place place;
};

/// Of memory, the same on every machine: samples; and a chunk's mesh, its polygons, the index that colliders
/// make of it and what the mesher keeps.
std::uint64_t bytes_of(const volume::ScalarGrid& grid, std::uint64_t full_chunks);
std::uint64_t bytes_of(const surface::GridChunkMesh& mesh);
/// Throws Error{usage} where a terrain of the frame takes more bytes than the settings allow.
void check_memory(std::uint64_t bytes, const volume::GridFrame& frame,
                  const DestructibleTerrainSettings& settings);

/// Each throws Error{usage} for settings that make no sense and for what takes more memory than they allow.
Ground ground_of(const scene::BuiltScene& scene, const DestructibleTerrainSettings& settings,
                 Progress& progress);
Ground ground_of(volume::ScalarGrid grid, Vec3d origin, const DestructibleTerrainSettings& settings);
/// A scene file or a volume file, by extension; else an elevation model.
Ground read_ground(const std::filesystem::path& file, const DestructibleTerrainSettings& settings,
                   Progress& progress);

}  // namespace tafoni::runtime::impl
