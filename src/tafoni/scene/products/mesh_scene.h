#pragma once
// From a built scene to a coloured mesh.

#include <cstdint>

#include "tafoni/core/progress.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/mesh/simplify.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::scene {

/// A mesh in world terms: its origin is the scene's.
struct MeshResult {
  mesh::Mesh mesh;
  surface::PolygonizeStats stats;
  mesh::SimplifyStats simplified;  ///< all zero when nothing was simplified
  double compile_seconds = 0, polygonize_seconds = 0, colour_seconds = 0, simplify_seconds = 0;
};

/// How the scene's surface is meshed on a lattice of cells of `voxel` metres.
surface::PolygonizeSettings polygonize_settings(const BuiltScene& scene, double voxel);

/// Polygonizes with the document's settings, colours by geology, slope and height, simplifies where asked.
MeshResult mesh_scene(const BuiltScene& scene, Progress& progress = silent());

/// What mesh_scene() does once the surface is meshed: `result.mesh` gets its origin and colours and is
/// simplified where asked.
void finish_mesh(const BuiltScene& scene, MeshResult& result, Progress& progress = silent());

/// The same, one mesh a tile of `tiles` x `tiles`, handed over from the calling thread. Seams meet exactly,
/// simplified or not. The result's mesh stays empty.
MeshResult mesh_scene_tiles(const BuiltScene& scene, int tiles, const surface::TileSink& sink,
                            Progress& progress = silent());

/// Colours the mesh's vertices by rock, slope and height.
void colour(const BuiltScene& scene, mesh::Mesh& mesh, Progress& progress = silent());

}  // namespace tafoni::scene
