#pragma once
// The rules that hoodoos grow by when a scene gives none.

#include "tafoni/core/params.h"

namespace tafoni::landforms::impl {

/// From the symbols Hoodoo, a pillar of beds with a cap, and Goblin, a squat one with a broad head.
Rows default_rules();

}  // namespace tafoni::landforms::impl
