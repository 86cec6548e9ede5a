#pragma once
// A scene cut open to show its rock [Paris19 figs. 3, 4].

#include "tafoni/core/progress.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/scene/build/build.h"

namespace tafoni::scene {

/// A line on the map in the scene's CRS. What lies to the right of the way from `from` to `to` is removed.
struct Cut {
  Vec2d from, to;
};

/// The cut from west to east through the middle; the south is removed.
Cut middle_cut(const BuiltScene& scene);

/// The ground behind the cut, carved as the scene says, with upright walls along the cut and the borders down
/// to the base; air that a wall passes through is left open. Coloured by resistance. Throws Error{usage} when
/// the line has no length or leaves nothing; warns when it removes nothing.
mesh::Mesh cut_mesh(const BuiltScene& scene, const Cut& cut, Progress& progress = silent());

/// Linear RGB of a resistance: dark brown for weak rock to cream for resistant rock.
Vec3f resistance_ramp(float resistance);

}  // namespace tafoni::scene
