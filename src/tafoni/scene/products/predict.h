#pragma once
// What a full build would cost.

#include <cstdint>

#include "tafoni/core/progress.h"
#include "tafoni/scene/build/build.h"

namespace tafoni::scene {

struct Prediction {
  double voxel = 0;
  double share = 1;  ///< of the terrain's columns that were meshed to count; 1: all
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t meshed = 0;      ///< triangles before they are simplified
  std::uint64_t memory = 0;      ///< bytes that a mesh takes beside the scene until it is written
  std::uint64_t file_bytes = 0;  ///< of a GLB
};

/// `tiles`: how many meshes along each side it is cut into.
Prediction predict(const BuiltScene& scene, int tiles = 1, Progress& progress = silent());

/// The least that predict() would say, found at once: what a flat terrain without any landform has, and the
/// walls about it.
Prediction least_prediction(const BuiltScene& scene, int tiles = 1);

/// Whether there is more of walls than of all else in that: few columns of a tall scene hold much of it, so
/// that predict() would mesh a good part.
bool is_tall(const BuiltScene& scene);

}  // namespace tafoni::scene
