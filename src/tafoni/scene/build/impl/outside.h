#pragma once
// What lies beside the terrain: it changes nothing that anyone sees, and users are told.

#include <cstdint>
#include <string>
#include <string_view>

#include "tafoni/core/progress.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/terrain/terrain.h"

namespace tafoni::scene::impl {

/// Whether something of the box, local metres, may lie above or below the domain.
bool over_domain(const terrain::Terrain& terrain, const Box3d& box);

/// The terrain's outline, up and down without end.
Box3d columns_of(const terrain::Terrain& terrain);

/// "the terrain (x 500000 to 500100, y 5699900 to 5700000)".
std::string terrain_place(const terrain::Terrain& terrain);

/// Warns that `count` of `all` things, "strokes", of a layer or a file are beside the terrain; says nothing
/// of none.
void warn_of_beside(const terrain::Terrain& terrain, std::string_view of, std::string_view things,
                    std::uint64_t count, std::uint64_t all, Progress& progress);

/// Warns where nothing of what a layer made, or of where it may act, is over the domain. `region` may be
/// null.
void warn_of_layer_beside(const terrain::Terrain& terrain, std::string_view layer,
                          const landforms::Result& made, const landforms::Region* region, Progress& progress);

}  // namespace tafoni::scene::impl
