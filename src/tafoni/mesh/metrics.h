#pragma once
// Measures of a mesh (area, volume and the like), in double.

#include <cstdint>
#include <vector>

#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh {

struct MeshMetrics {
  std::uint64_t vertices = 0;  ///< that a triangle uses
  std::uint64_t triangles = 0, edges = 0;
  std::uint64_t components = 0;      ///< joined by shared vertices
  std::uint64_t boundary_loops = 0;  ///< closed chains of edges that have one triangle
  double area = 0;                   ///< square metres
  double volume = 0;                 ///< cubic metres enclosed, signed; means little if not closed
  bool closed = false;
  std::int64_t euler = 0;  ///< V - E + F
  double genus = 0;        ///< handles, summed over components: (2 components - loops - euler) / 2
  Box3d bounds;            ///< world: origin added
  double shortest_edge = 0, mean_edge = 0, longest_edge = 0;  ///< metres
};

/// Triangles that name missing vertices are ignored.
MeshMetrics metrics(const Mesh& mesh);

/// Component of each vertex, by triangles that share a vertex, numbered from 0 in the order of their first
/// vertex; vertices that no triangle uses are components of their own.
std::vector<std::uint32_t> vertex_components(const Mesh& mesh, std::uint32_t* count = nullptr);

}  // namespace tafoni::mesh
