#pragma once
// An intersection without a sharp edge.

#include "tafoni/field/tree.h"

namespace tafoni::field {

/// Solid where both are, and their common edge is worn off: min(a, b) - h^2 / (4 width) with h = width - |a -
/// b| where that is positive, and exactly the lesser elsewhere. The edge of two faces at a right angle
/// recedes by 0.35 width. `width` in metres of the values, above 0. Throws Error{usage} for another.
NodePtr rounded(NodePtr a, NodePtr b, double width);

}  // namespace tafoni::field
