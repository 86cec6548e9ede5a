#pragma once
// One function in the place of another, within a region.

#include "tafoni/field/function.h"

namespace tafoni::landforms::impl {

/// `old` where the control is 0, `now` where it is 1, between them in proportion. Each is asked only where it
/// counts.
field::FunctionPtr replace_within(field::FunctionPtr old, field::FunctionPtr now, field::FunctionPtr control);

}  // namespace tafoni::landforms::impl
