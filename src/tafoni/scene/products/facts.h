#pragma once
// What landforms tell of themselves, as reports show it: to programs as JSON, to people as text.

#include <cstdint>
#include <string>
#include <utility>

#include "tafoni/core/params.h"
#include "tafoni/landforms/facts.h"
#include "tafoni/landforms/landform.h"

namespace tafoni::scene {

/// A fact's key, which ends in its unit ("tunnel_length_m"), and its value: places as world x, y and z, one
/// after another. `origin` is the world position of local zero.
std::pair<std::string, Value> report_entry(const landforms::Fact& fact, Vec3d origin);

/// Facts as people read them: "tunnel length 12.3 m, mouths 2". Left out are lists, which are for programs,
/// and the number of primitives, which primitives_of() gives.
std::string facts_text(const landforms::Facts& facts);

/// How many primitives a layer put into the tree, as it counts them or else as its nodes hold them.
std::int64_t primitives_of(const landforms::Result& made);

}  // namespace tafoni::scene
