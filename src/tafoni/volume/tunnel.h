#pragma once
// Fractal tunnels: open space about a midpoint-displaced axis [Ju01 §3].

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/math/vec.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {

struct AxisPoint {
  Vec3d position;     ///< local metres
  double radius = 1;  ///< metres, positive
};

/// Spheres swept along a polyline, their radius linear from point to point.
struct Tunnel {
  std::vector<AxisPoint> axis;
  /// Metres below the axis at which ground fills it, level across, so that one can walk; 1e9 leaves the
  /// floor round, as [Ju01 §3] has it.
  double floor = 1e9;
};

struct TunnelSettings {
  double radius = 3;      ///< metres, on average
  double swelling = 0.3;  ///< most that the radius differs from it, as a share
  /// Most that a midpoint moves sideways, as a share of its segment's length; the next level's segments are
  /// half as long. 0 keeps the axis straight.
  double wander = 0.2;
  double climb = 0.4;  ///< of that, the share by which it moves up or down
  double step = 2;     ///< metres: segments are halved until none is longer
  double slope = 10;   ///< tangent of the steepest slope of the axis, where the ends allow it; 10: no limit
  double floor = 1;    ///< its depth as a share of the radius; 1: round
  std::uint64_t seed = 0;
};

/// A tunnel between two points, by (settings, ends) alone. Throws Error{usage} for a radius or step that is
/// not positive.
Tunnel fractal_tunnel(Vec3d from, Vec3d to, const TunnelSettings& settings);

/// Moves the points of an axis up and down, but for its ends, until it is nowhere steeper than `slope`, a
/// tangent, and nowhere above `highest` at the place of the point; none: unlimited. False where the ends do
/// not allow it.
bool level_axis(std::vector<AxisPoint>& axis, double slope,
                const std::function<double(Vec3d)>& highest = nullptr);

double length(const Tunnel& tunnel);  ///< of the axis, metres
/// The least of distance to the axis - radius there, over all of the axis: negative inside.
double distance(const Tunnel& tunnel, Vec3d p);
/// Encloses all that is nearer than `reach` to the wall or inside.
Box3d bounds(const Tunnel& tunnel, double reach);

/// f = min(f, distance(p)) at every sample where distance(p) < reach, to a rounding of floats. No sample
/// rises. [Ju01] propagates distances from the axis from sample to sample; here they go out brick by
/// brick of 8^3 samples as far as a segment reaches, stop where all that stands is lower, and only the
/// segments that may be the nearest in a brick are looked at in it: exact, and time and memory follow the
/// tunnel's volume, not the grid's. Gives the box of what changed.
SampleBox carve(ScalarGrid& grid, std::span<const Tunnel> tunnels, double reach,
                Progress& progress = silent());

}  // namespace tafoni::volume
