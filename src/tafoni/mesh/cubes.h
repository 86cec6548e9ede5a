#pragma once
// Volume by counting cubes [Zawadzki §4.2].

#include <cstdint>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh {

struct Cubes {
  double edge = 0;          ///< C_E, metres
  std::uint64_t count = 0;  ///< N_C: cubes of the lattice whose eight corners lie inside
  double volume() const { return static_cast<double>(count) * edge * edge * edge; }
};

/// The cubes inside a solid, within `box`; both are in local metres. Cubes lie on the global lattice of
/// multiples of `edge`. V_M = N_C C_E^3 is too small by half a cube times the areas that the surface shows
/// along x, y and z, that is by half a cube times a level surface, or three quarters on a sphere. Throws
/// Error{usage} for more than 2^31 samples along an axis.
Cubes inside_cubes(const field::CompiledField& field, const Box3d& box, double edge,
                   Progress& progress = silent());

/// The cubes inside a closed mesh, by where lines parallel to z cross it. The lattice stands off multiples of
/// `edge` by an odd fraction, so that no line meets an edge of a mesh made on a lattice. Means nothing where
/// the mesh is not closed. Throws Error{usage} for more than 2^24 columns of cubes, or 2^29 cubes in a row of
/// columns.
Cubes inside_cubes(const Mesh& mesh, double edge, Progress& progress = silent());

}  // namespace tafoni::mesh
