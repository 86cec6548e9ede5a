#pragma once
// Where tunnels may go: mouths on hillsides, and ways between them and other ends that stay under the ground,
// can be walked and do not cross one another. It plans only; a Hollow digs.

#include <functional>
#include <optional>
#include <vector>

#include "tafoni/field/compiled.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/volume/tunnel.h"

namespace tafoni::landforms::impl {

/// What landforms let users choose of tunnels.
struct TunnelParams {
  double radius = 2.5;     ///< metres, on average
  double swelling = 0.25;  ///< most that the radius differs from it, as a share
  /// Most that a stretch's middle lies off its straight line, as a share of its length.
  double wander = 0.22;
  double floor = 0.55;  ///< radii below the axis
  double cover = 3;     ///< metres of rock over a roof
};

/// A tunnel of these parameters; its slope and seed are still the defaults.
volume::TunnelSettings tunnel_settings(const TunnelParams& params);

struct TunnelPlannerSettings : TunnelParams {
  Box3d area;            ///< local; x and y of where to dig
  double slope = 0.5;    ///< tangent of the steepest way
  double lowest = -1e9;  ///< local z under which nothing is dug
  std::uint64_t seed = 0;
};

/// A place on a hillside where a tunnel can open.
struct Mouth {
  Vec3d ground;  ///< local, on the surface, where its floor begins
  Vec3d inward;  ///< unit, horizontal
  double slope;  ///< of the ground, radians
};

/// An end of a way: where its floor is, and the horizontal direction in which one goes on from there.
struct WayEnd {
  Vec3d floor;
  Vec3d ahead;
  double straight = 0;  ///< metres that the way keeps to this direction
  bool open = false;    ///< whether it lies under no roof
};

class TunnelPlanner {
 public:
  TunnelPlanner(const Ground& ground, const TunnelPlannerSettings& settings, Progress& progress);

  /// The best hillsides come first, otherwise in random order.
  const std::vector<Mouth>& mouths() const { return mouths_; }
  WayEnd end_of(const Mouth& mouth) const;
  /// Local z of the lowest roof of rock within `around` of a place: below it all is rock. It is -1e30 off the
  /// area.
  double roof(double x, double y, double around) const;
  /// From now on ways do not cross this one where one would fall from floor to floor.
  void keep_off(const volume::Tunnel& dug);
  /// A tunnel that stays under the ground but at open ends, off what `avoid` says, and can be walked;
  /// windings are added where it would be too steep. None where there is no such way.
  std::optional<volume::Tunnel> way(const WayEnd& from, const WayEnd& to, std::uint64_t seed,
                                    const std::function<bool(Vec3d)>& avoid = nullptr) const;

 private:
  void look_for_roofs();
  void look_for_mouths(Progress& progress);
  bool good(const Mouth& mouth) const;
  bool crosses(const volume::Tunnel& way, const WayEnd& from, const WayEnd& to) const;
  std::optional<volume::Tunnel> attempt(const WayEnd& from, const WayEnd& to, std::uint64_t seed,
                                        double lengthen, const std::function<bool(Vec3d)>& avoid) const;

  const Ground& ground_;
  TunnelPlannerSettings s_;
  field::CompiledField field_;
  raster::Raster roofs_;
  std::vector<Mouth> mouths_;
  std::vector<volume::AxisPoint> dug_;
};

}  // namespace tafoni::landforms::impl
