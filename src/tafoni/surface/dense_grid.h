#pragma once
// Polygonization of a dense grid of samples, by the same core as polygonize.h.

#include <cstddef>

#include "tafoni/mesh/mesh.h"

namespace tafoni::surface {

/// A dense grid: sample (i, j, k) is samples[(k * ny + j) * nx + i] and lies at (i, j, k) * spacing.
struct DenseGrid {
  const float* samples = nullptr;
  int nx = 0, ny = 0, nz = 0;  ///< samples a side, 2 to 4096
  double spacing = 1;
};

/// The surface f = 0, solid where f > 0; open where it leaves the grid. Normals are minus the gradient by
/// central differences (one-sided at the grid's faces), interpolated along the edge. `out` is overwritten;
/// its memory is reused.
void polygonize_grid(const DenseGrid& grid, bool normals, mesh::Mesh& out);

}  // namespace tafoni::surface
