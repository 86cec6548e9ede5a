#pragma once
// A level tunnel through a hill: where the way from one side to the other is shortest.

#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// Parameters of prism-field, metres.
struct TunnelSettings {
  double tunnel = 0;  ///< radius; 0: none is wanted
  double cover = 0;   ///< how deep below the hill's top it runs; 0: a quarter of the relief
};

/// Both mouths, on the axis, local; empty, with a warning, where no hill has so much cover. `grain` is the
/// step of the search, metres.
std::vector<Vec3d> find_hill_tunnel(const Ground& ground, const TunnelSettings& settings, double grain,
                                    Progress& progress);

}  // namespace tafoni::landforms::impl
