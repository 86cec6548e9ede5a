#pragma once
// Poisson-sphere sampling of an implicit surface (document 003, section 6.1).

#include <cstdint>
#include <functional>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms {

struct SurfacePoint {
  Vec3d position;  ///< on f = 0 to within a hundredth of the spacing
  Vec3d normal;    ///< unit, from rock to air
};

/// Points of the surface inside `box` (local metres), none closer than `spacing` to another and, where `keep`
/// holds all around, no place of the surface farther than about twice that from one. `keep(p)` may refuse a
/// candidate cheaply before it is projected; it is given the middle of a cell of 0.75 spacing. Independent of
/// threads.
std::vector<SurfacePoint> sample_surface(const field::CompiledField& field, const Box3d& box, double spacing,
                                         std::uint64_t seed, const std::function<bool(Vec3d)>& keep,
                                         Progress& progress = silent());

}  // namespace tafoni::landforms
