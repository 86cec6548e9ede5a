#pragma once
// What indexes over triangles, our own and Embree's, can be given.

#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh::inner {

/// Metres from the origin. As far as places in scene files go; the squares of squares that trees work with
/// still are floats.
inline constexpr float farthest_vertex = 1e9f;

/// Throws Error{input} for a triangle of vertices that are not there, for a vertex that is not finite or lies
/// farther off, and for normals or colours that are not one a vertex.
void check_traceable(const Mesh& mesh);

}  // namespace tafoni::mesh::inner
