// Tries level lines in twelve directions through the places of a grid, at the wanted depth, until they come
// out on both sides where open air lies before a mouth; the cheapest is taken.

#include "tafoni/landforms/prism-field/hill_tunnel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/core.h>

namespace tafoni::landforms::impl {
namespace {

// Chosen by eye.
constexpr double default_cover = 0.25;          // of the relief
constexpr double places = 40;                   // of the grid, along the shorter side
constexpr double longest_share = 0.6;           // of the shorter side: a longer way is no hill's
constexpr double shortest = 6;                  // radii; a shorter way would be a window, not a tunnel
constexpr double border = 6, mouth_border = 4;  // grains kept to the outline, by middles and by mouths
constexpr int turns = 12;                       // over half a circle
constexpr double drop_counts = 4;         // metres of way that a metre of drop below a mouth is as bad as
constexpr double radii_before_mouth = 2;  // radii to where that drop is measured
constexpr double sill = 0.8;              // radii below the axis: ground lower than this leaves a mouth open

class TunnelSearch {
 public:
  TunnelSearch(const Ground& ground, const TunnelSettings& settings, double grain)
      : ground_(ground), radius_(settings.tunnel), grain_(grain) {}

  std::vector<Vec3d> run(double cover, double longest) {
    const Box3d& box = ground_.box();
    const Vec3d extent = box.size();
    const double stride = std::max(2 * grain_, std::min(extent.x, extent.y) / places);
    const double margin = border * grain_;
    for (double y = box.lo.y + margin; y < box.hi.y - margin; y += stride)
      for (double x = box.lo.x + margin; x < box.hi.x - margin; x += stride) {
        const double z = ground_.height(x, y) - cover;
        for (int turn = 0; turn < turns; ++turn) {
          const double angle = turn * std::numbers::pi / turns;
          consider({x, y, z}, {std::cos(angle), std::sin(angle), 0}, longest);
        }
      }
    return std::move(mouths_);
  }

 private:
  void consider(Vec3d middle, Vec3d along, double longest) {
    const double most = std::min(least_, longest);
    const double ahead = way_out(middle, along, most);
    const double back = way_out(middle, -along, most - ahead);
    if (!(ahead + back < most) || ahead + back < shortest * radius_) return;
    const Vec3d front = middle + along * ahead, rear = middle - along * back;
    // A mouth high in a cliff is no way in.
    const double cost = ahead + back + drop_counts * (drop(front, along) + drop(rear, -along));
    if (!(cost < least_)) return;
    least_ = cost;
    mouths_ = {front, rear};
  }

  /// From the floor at a mouth down to the ground before it.
  double drop(Vec3d mouth, Vec3d out) const {
    const Vec3d p = mouth + out * (radii_before_mouth * radius_);
    return std::max(0.0, mouth.z - radius_ - ground_.height(p.x, p.y));
  }

  /// Metres to where the ground falls below the tunnel's floor; infinite if that is beyond `most`.
  double way_out(Vec3d from, Vec3d along, double most) const {
    const double step = std::max(grain_, 0.25 * radius_);
    for (double d = step; d < most; d += step) {
      const Vec3d p = from + along * d;
      if (!ground_.usable(p)) break;
      if (ground_.height(p.x, p.y) >= from.z - sill * radius_) continue;
      if (ground_.usable(p, mouth_border * grain_)) return d;
      break;
    }
    return std::numeric_limits<double>::infinity();
  }

  const Ground& ground_;
  double radius_, grain_;
  double least_ = std::numeric_limits<double>::infinity();
  std::vector<Vec3d> mouths_;
};

}  // namespace

std::vector<Vec3d> find_hill_tunnel(const Ground& ground, const TunnelSettings& settings, double grain,
                                    Progress& progress) {
  const auto& heights = ground.site().heights->values.values();
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double relief = *high - *low;
  const double cover = settings.cover > 0 ? settings.cover : default_cover * relief;
  const Vec3d extent = ground.box().size();
  const double longest = longest_share * std::min(extent.x, extent.y);
  auto mouths = TunnelSearch(ground, settings, grain).run(cover, longest);
  if (mouths.empty())
    progress.warn(
        fmt::format("prism-field bores no tunnel: no hill has {:.0f} m of cover over less than {:.0f} m; "
                    "give a smaller cover",
                    cover, longest));
  return mouths;
}

}  // namespace tafoni::landforms::impl
