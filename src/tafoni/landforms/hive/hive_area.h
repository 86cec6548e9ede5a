#pragma once
// The ground that a hive takes.

#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// A square of `size` metres about the site's first point, or where heights differ most; local. It reaches
/// `depth` metres below the lowest ground, 0 for almost the terrain's influence.
Box3d find_hive_area(const Ground& ground, double size, double depth);

}  // namespace tafoni::landforms::impl
