#pragma once
// A solid as a leaf of a construction tree.

#include "tafoni/field/tree.h"
#include "tafoni/grammar/pose.h"

namespace tafoni::grammar {

/// The solid's distance, placed. Leaves that share a solid share its memory.
field::NodePtr leaf(SolidPtr solid, const Pose& pose);
field::FunctionPtr as_function(SolidPtr solid, const Pose& pose);

}  // namespace tafoni::grammar
