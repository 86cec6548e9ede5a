#pragma once
// Edits of scalar grids: tools that remove or add material, and explosions [Ruths01].
//
// Every edit takes the grid's amplitude, the greatest magnitude that its values saturate at. Nothing beyond
// it is written, so that rock and air away from the surface stay uniform and their chunks one value.

#include <functional>

#include "tafoni/volume/scalar_grid.h"
#include "tafoni/volume/tool.h"

namespace tafoni::volume {

/// With d the tool's distance (of a hull, no nearer than its bounds are), at most `amplitude`: remove makes a
/// value min(v, -d), add max(v, d), wherever d > -amplitude; other samples stay as they are. Of a grid within
/// its amplitude that is what the difference and the union with the tool give. Returns the box of the samples
/// whose value changed. Throws Error{usage} for an amplitude that is not above 0.
SampleBox apply(ScalarGrid& grid, const Tool& tool, Edit edit, double amplitude);

/// Adds change(r / radius) to the samples at r < radius metres from `center`. A value goes no further than
/// the amplitude unless it was there before. Otherwise as apply().
SampleBox add_radial(ScalarGrid& grid, Vec3d center, double radius,
                     const std::function<double(double)>& change, double amplitude);

/// Subtracts energy * (1 - (r / radius)^2)^3; a negative energy adds. [Ruths01] has rock negative and
/// adds. Otherwise as add_radial().
SampleBox explode(ScalarGrid& grid, Vec3d center, double radius, double energy, double amplitude);

}  // namespace tafoni::volume
