#pragma once
// Simplification of a mesh in patches whose borders stay as they are.

#include <cstdint>
#include <span>
#include <vector>

#include "tafoni/mesh/inner/topology.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh::impl {

using inner::FanCounter;
using inner::for_each_edge;
using inner::incidence;
using inner::Incidence;
using inner::Triangle;

/// Some triangles of a mesh, before and after.
struct Patch {
  std::vector<Triangle> given, result;
  std::uint32_t id = 0;
  bool done = false;      ///< result is made
  bool broken = false;    ///< result is not a clean surface at a vertex of its own
  bool parted = false;    ///< makes no edge between shared vertices that the neighbour might make, too
  int halvings = 0;       ///< of the error, after attempts that broke the surface
  bool rejected = false;  ///< result is given
};

/// Which patch each vertex belongs to, and which vertices several share.
class Ownership {
 public:
  explicit Ownership(std::size_t vertices) : owners_(vertices, none), shared_(vertices, false) {}
  /// Gives a patch an id and its vertices to it; those that are `parent`'s still count as not taken.
  void take(Patch& patch, std::uint32_t parent = none);
  bool shared(std::uint32_t v) const { return shared_[v]; }

  static constexpr std::uint32_t none = 0xffffffff;

 private:
  std::uint32_t next_ = 0;
  std::vector<std::uint32_t> owners_;
  std::vector<bool> shared_;
};

/// Cuts triangles into patches of about `wanted` by the columns of a horizontal grid; `shift` in [0, 1) moves
/// the grid by that share of a column, so that the seams of one round lie inside the patches of the next.
std::vector<Patch> cut(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                       std::size_t wanted, double shift);

/// What the patches are cut from.
struct Surface {
  std::span<const Vec3f> positions;
  /// Vertices between which nothing may be made that was not given, as flags; empty: no such vertices.
  const std::vector<bool>& seam;
};

/// Fills patch.result with what quadric edge collapse within `error` metres leaves of patch.given, and
/// patch.broken with whether that is clean at the vertices it shares with no other patch.
void collapse(const Surface& surface, const Ownership& ownership, Patch& patch, double error);

/// Mends triangles without area, as edge collapse makes them where the surface is exactly flat: the longest
/// edge is flipped with the neighbour's, which leaves the shape as it is. Those that cannot be mended stay.
void flip_flat_triangles(std::span<const Vec3f> positions, std::vector<Triangle>& triangles);

/// Vertices at which triangles do not form one clean fan: an edge of more than two triangles or of two that
/// run the same way, several fans, a triangle without area or given twice.
std::vector<bool> broken_vertices(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

/// Those among the vertices that patches share. Vertices of the whole mesh, as flags.
std::vector<bool> broken_shared_vertices(std::span<const Vec3f> positions, const Ownership& ownership,
                                         std::span<const Patch> patches);

}  // namespace tafoni::mesh::impl
