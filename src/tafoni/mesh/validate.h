#pragma once
// Checks what every mesh of the program promises: 2-manifold, oriented, no degenerate triangles, no bad data.

#include <cstdint>
#include <string>
#include <vector>

#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh {

struct MeshReport {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t components = 0;
  std::uint64_t boundary_edges = 0;         ///< used by one triangle
  std::uint64_t non_manifold_edges = 0;     ///< used by more than two
  std::uint64_t non_manifold_vertices = 0;  ///< whose triangles form more than one fan
  std::uint64_t orientation_conflicts = 0;  ///< edges that both triangles pass in the same direction
  std::uint64_t degenerate_triangles = 0;   ///< a repeated vertex or position, or zero area
  std::uint64_t slivers = 0;                ///< an angle below 1 degree; a remark, not a defect
  std::uint64_t duplicate_triangles = 0;    ///< the same three vertices again
  std::uint64_t unused_vertices = 0;
  std::uint64_t index_errors = 0;     ///< triangles that name a vertex that is not there
  std::uint64_t bad_positions = 0;    ///< NaN or infinite
  std::uint64_t bad_normals = 0;      ///< NaN, not of unit length (to 1e-3), or not one a vertex
  std::uint64_t flipped_normals = 0;  ///< triangles that face away from the mean of their corners' normals:
                                      ///< drawn too dark or too bright; a remark, not a defect

  bool closed() const { return triangles > 0 && boundary_edges == 0; }
  /// 2-manifold (possibly with border), oriented, without bad data.
  bool valid() const {
    return non_manifold_edges + non_manifold_vertices + orientation_conflicts + degenerate_triangles +
               duplicate_triangles + unused_vertices + index_errors + bad_positions + bad_normals ==
           0;
  }
};

/// Linear time, no more memory than the mesh itself. Never throws on a bad mesh.
MeshReport validate(const Mesh& mesh);

/// One line a defect, with its count; empty for a valid mesh.
std::vector<std::string> defects(const MeshReport& report);

}  // namespace tafoni::mesh
