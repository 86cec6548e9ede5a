#pragma once
// Random walks through the ground: whether all that can be reached is reached, and how deep a walker ever was
// in the rock, measured by other means than its own.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/query/routes.h"

namespace tafoni::query {

struct WalkSettings {
  int count = 1000;    ///< routes
  int around = 40;     ///< routes about one starting place
  double least = 4;    ///< metres, the shortest route
  bool roofed = true;  ///< start under rock
  std::uint64_t seed = 1;
  double seconds = 0.05;  ///< a move, of at most routes.move metres
  WalkerSettings walker = {};
  RouteSettings routes = {.spacing = 0.5, .move = 0.15, .places = 1000};
};

struct Walk {
  Vec3d from, to;
  Walked walked;
  double overlap = 0;  ///< metres: how far the surface's triangles came into the capsule, at worst
  double depth = 0;    ///< the greatest that `check` told
};

/// Random routes between places that a walker can reach from random places in the box, and what came of
/// walking them. `check`, if given, is asked after every move and tells how deep the walker is in the rock;
/// the same is found from the surface nearest to points of its axis. Does not depend on threads. Throws
/// Error{input} where the box has no place to stand from which others can be reached.
std::vector<Walk> random_walks(const Collider& ground, const Box3d& box, const WalkSettings& settings,
                               const std::function<double(const Capsule&)>& check = {},
                               Progress& progress = silent());

/// Points all over the capsule's surface, drawn in by `inset` metres.
std::vector<Vec3d> surface_points(const Capsule& shape, double inset);

/// Metres from a place in the field's rock to the nearest air, 0 in the air. Asks the field's signs, since
/// its values are no distances, along lines in 26 directions: what is less wide than far off may be
/// overlooked, and none is found beyond 100 m, which is then the answer.
double depth_in(const field::CompiledField& field, Vec3d p);

}  // namespace tafoni::query
