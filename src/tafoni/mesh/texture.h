#pragma once
// Texture coordinates for programs that cannot project from three sides by themselves.

#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh {

/// Cosine of the greatest slant of a triangle to the side from which its picture comes: no stretch above 2.5.
inline constexpr float least_facing = 0.4f;

/// Projects from the six sides of a box: each triangle gets the coordinates of the axes across the one that
/// its surroundings face most, so that a picture of `size` metres repeats unmirrored; where it slants too
/// much to that side, the one that it faces most itself. Coordinates meet across edges except where triangles
/// have different sides; they are metres / `size` and leave 0 to 1, as repeated pictures do. Throws
/// Error{usage} for a size that is no length.
void box_texture(Mesh& mesh, double size);

}  // namespace tafoni::mesh
