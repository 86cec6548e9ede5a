#pragma once
// What landforms tell of themselves, as reports show it.

#include <string>
#include <utility>

#include "tafoni/core/params.h"
#include "tafoni/landforms/facts.h"

namespace tafoni::scene {

/// A fact's key, which ends in its unit ("tunnel_length_m"), and its value: places as world x, y and z, one
/// after another. `origin` is the world position of local zero.
std::pair<std::string, Value> report_entry(const landforms::Fact& fact, Vec3d origin);

}  // namespace tafoni::scene
