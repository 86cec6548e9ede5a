#pragma once
// Makes a closed surface that touches itself along edges or at corners 2-manifold.

#include <cstdint>
#include <vector>

#include "tafoni/mesh/mesh.h"

namespace tafoni::surface::impl {

/// `mesh` has positions and triangles, oriented, of which as many pass every edge in either direction; where
/// more than two meet at an edge, solid separates: each joins the one across the solid between them. Vertices
/// are repeated for every fan of triangles, triangles that cover each other go, and an edge that would join
/// the same two vertices as another is cut in its middle. `tags`, one a triangle, keep pace. Vertices that no
/// triangle uses go; others keep their order, copies following their first.
void separate(mesh::Mesh& mesh, std::vector<std::uint8_t>& tags);

}  // namespace tafoni::surface::impl
