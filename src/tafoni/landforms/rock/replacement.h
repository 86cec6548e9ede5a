#pragma once
// Puts one function in the place of another within a region.

#include "tafoni/field/function.h"

namespace tafoni::landforms::impl {

/// A function that is `old` where the control is 0, `now` where it is 1, and mixes them in proportion
/// between. Each is asked only where it counts.
field::FunctionPtr replace_within(field::FunctionPtr old, field::FunctionPtr now, field::FunctionPtr control);

}  // namespace tafoni::landforms::impl
