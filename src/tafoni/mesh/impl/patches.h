#pragma once
// Simplification of a mesh in patches whose borders stay as they are.

#include <cstdint>
#include <span>
#include <vector>

#include "tafoni/mesh/impl/topology.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh::impl {

/// Some triangles of a mesh, before and after.
struct Patch {
  std::vector<Triangle> given, result;
  int halvings = 0;       ///< of the error, after attempts that broke the surface
  bool rejected = false;  ///< result is given
};

/// Cuts triangles into patches of about `wanted` by the columns of a horizontal grid; `shift` in [0, 1) moves
/// the grid by that share of a column, so that the seams of one round lie inside the patches of the next.
std::vector<Patch> cut(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                       std::size_t wanted, double shift);

/// Fills patch.result with what quadric edge collapse within `error` metres leaves of patch.given.
void collapse(std::span<const Vec3f> positions, Patch& patch, double error);

/// Mends triangles without area, as edge collapse makes them where the surface is exactly flat: the longest
/// edge is flipped with the neighbour's, which leaves the shape as it is. Those that cannot be mended stay.
void flip_flat_triangles(std::span<const Vec3f> positions, std::vector<Triangle>& triangles);

/// Vertices at which triangles do not form a clean fan: an edge of more than two triangles or of two that run
/// the same way, several fans, a triangle without area or given twice.
std::vector<bool> broken_vertices(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

}  // namespace tafoni::mesh::impl
