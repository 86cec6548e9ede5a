#pragma once
// How convex a mesh is [Zawadzki §4.3].

#include <cstdint>

#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh {

/// Pairs of triangles that share an edge, by how they meet there.
struct Convexity {
  std::uint64_t convex = 0;   ///< T_G: bent away from the outside, like the edges of a cube
  std::uint64_t concave = 0;  ///< T_L
  std::uint64_t flat = 0;     ///< within the tolerance; in neither
  /// C_F = 100 T_G / (T_G + T_L), percent; 100 where nothing is bent.
  double factor() const;
};

/// An edge is convex where each triangle lies behind the other's plane. [Zawadzki §4.3] says both that d > 0
/// is concave and that T_G, which counts the greater angles, makes the factor of a cube 100 %; the cube
/// decides here. Edges bent by less than `flat` radians count in neither, or the diagonals of a cube's faces
/// would. Edges of one triangle, or of more than two, are left out.
Convexity convexity(const Mesh& mesh, double flat = 1e-3);

}  // namespace tafoni::mesh
