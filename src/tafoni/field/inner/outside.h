#pragma once
// What of a tree lies beside a box, or too far off for any tree.

#include <cstdint>

#include "tafoni/field/tree.h"

namespace tafoni::field {

/// Metres from the origin, along each axis, within which primitives must lie with all that they reach.
inline constexpr double farthest = 131000;

/// How many primitives of the tree have a support that does not touch `box`, local metres. Those of placed
/// copies are not counted.
std::uint64_t primitives_outside(const NodePtr& root, const Box3d& box);

}  // namespace tafoni::field
