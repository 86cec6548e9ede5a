#pragma once
// Tunnels and chambers as open space in the ground: one scalar grid, whose walls are bedded rock.

#include <memory>
#include <string>
#include <vector>

#include "tafoni/landforms/rock/rock_shape.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/volume/chamber.h"
#include "tafoni/volume/tunnel.h"

namespace tafoni::landforms::impl {

/// Parameters that all of these landforms have.
struct HollowParams {
  double spacing = 0;
  double roughness = 0.25;
  double relief = 0.5;
};
template <class P>
void add_hollow_params(ParamTable<P>& t) {
  t.real("spacing", &P::spacing, "m", 0, 100,
         "Distance between the samples of the volume: less is finer and slower; 0 for a fifth of the radius")
      .real("roughness", &P::roughness, "m", 0, 20, "Most that walls and floors are uneven")
      .real("relief", &P::relief, "m", 0, 50,
            "How far beds of soft rock recede behind hard ones; 0 for plain walls");
}

class Hollow {
 public:
  /// `radius` is that of tunnels, which the defaults follow.
  Hollow(const Ground& ground, const HollowParams& params, double radius);

  void add(volume::Tunnel tunnel) { tunnels_.push_back(std::move(tunnel)); }
  void add(volume::Chamber chamber) { chambers_.push_back(std::move(chamber)); }
  /// Metres between the samples of the volume. Chambers could do with fewer.
  double spacing() const { return spacing_; }

  /// Reshapes the tree to the smooth minimum of itself and the distance to the walls, but where the site may
  /// not be changed. The facts tell the tunnels' length, the volume carved and where to walk: `routes`,
  /// places along the floor of every tunnel, one tunnel after another, `route_points` of them each.
  Result finish(Progress& progress) const;

 private:
  Box3d bounds(double reach) const;
  /// Throws Error{usage} where the spacing is too fine for what is dug and `reach` metres of rock about it.
  void check_size(double reach) const;
  void tell_routes(Facts& facts) const;

  const Ground& ground_;
  RockTexture texture_;
  double spacing_;
  std::vector<volume::Tunnel> tunnels_;
  std::vector<volume::Chamber> chambers_;
};

}  // namespace tafoni::landforms::impl
