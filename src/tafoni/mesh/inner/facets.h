#pragma once
// What the triangles around a vertex say its normal is, to judge normals that come from elsewhere.

#include "tafoni/math/vec.h"

namespace tafoni::mesh::inner {

/// Cosine of the greatest angle (37 degrees) between a vertex's own normal and the mean of the triangles
/// around it. Beyond it the triangles do not show what the normal speaks of: a crease, or detail finer than
/// an edge. On a coast of 1 m voxels 0.10 % of the triangles face away from the mean of their normals with a
/// limit of 0, 0.029 % with 0.5 and 0.006 % with 0.8, which replaces 2.6 % of the normals.
inline constexpr float least_agreement = 0.8f;

/// Whether the two are farther apart than that; of one vertex, or of several at once (T a vector of floats).
/// `sum` is of the facet vectors (along the outward normal, as long as twice the area) of the triangles
/// around the vertex. A sum of zero disagrees with nothing.
template <class T>
auto disagree(Vec3<T> normal, Vec3<T> sum) {
  const T squared = dot(sum, sum), along = dot(normal, sum);
  const auto near = (along > 0) & (along * along >= least_agreement * least_agreement * squared);
  return (squared > 0) & (near == 0);
}

/// `normal`, or the direction of `sum` where the two disagree.
inline Vec3f agreeing(Vec3f normal, Vec3f sum) {
  return disagree(normal, sum) ? normalized(sum) : normal;
}

}  // namespace tafoni::mesh::inner
