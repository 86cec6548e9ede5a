#pragma once
// Texture coordinates for programs that cannot project from three sides by themselves.

#include "tafoni/mesh/mesh.h"

namespace tafoni::mesh {

/// Projects from the six sides of a box: each triangle gets the coordinates of the axes across the one that
/// it faces most, so that a picture of `size` metres repeats unmirrored. Coordinates meet across edges except
/// where triangles face different sides. Throws Error{usage} for a size that is no length.
void box_texture(Mesh& mesh, double size);

}  // namespace tafoni::mesh
