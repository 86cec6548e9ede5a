#pragma once
// From the numbers of a mesh file to floats about an origin. Map coordinates are too large for floats: at a
// northing of 5,900,000 m a float's steps are half a metre.

#include <optional>
#include <span>

#include "tafoni/mesh/mesh.h"

namespace tafoni::io::impl {

/// Gives `mesh` the positions `given`, metres from `stated`, which is the origin that the file names, if it
/// names one. A mesh that lies far from zero for its size gets an origin in its middle, a round number,
/// before anything becomes a float. Numbers that are floats anyway stay relative to the origin that the file
/// names, so that tiles still meet bit for bit. The triangles tell which positions count.
void place(mesh::Mesh& mesh, std::span<const Vec3d> given, const std::optional<Vec3d>& stated);

/// The same for a file of floats, which are the mesh's positions already.
void place(mesh::Mesh& mesh, const std::optional<Vec3d>& stated);

}  // namespace tafoni::io::impl
