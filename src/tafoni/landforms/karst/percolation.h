#pragma once
// Modified invasion percolation [Paris19 §6.2]: water works its way down through the least
// resistant rock.

#include <cstdint>
#include <vector>

#include "tafoni/field/compiled.h"
#include "tafoni/landforms/karst/entrances.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// Parameters of karst.
struct PercolationSettings {
  double depth = 80;            ///< a network stays within this below its seed, metres
  double resistance = 0.75;     ///< rho_0: rock as hard as this or harder is not carved
  double epsilon = 0.1;         ///< range of the random share of the order
  std::int64_t directions = 6;  ///< tried around each carved point
  double steepness = 0.35;      ///< factor on the downward part of a direction; 1: uniform on the hemisphere
};

/// The room that a network has, by the size of its passages and the site; metres.
struct PercolationSpace {
  double spacing = 12;   ///< radius of the Poisson spheres
  double cover = 8;      ///< rock over every point but seeds and exits
  double base_z = -1e9;  ///< no point lies lower, local
  double face_z = 0.8;   ///< a tunnel may come out where the outward normal's z is below this
  std::size_t points_per_seed = 40;
  std::uint64_t seed = 0;
};

/// A carved point.
struct CaveNode {
  Vec3d position;
  std::int32_t parent = -1;  ///< an earlier node; -1: a seed
  std::int32_t start = 0;    ///< the seed it descends from, by its place in the list
  double resistance = 0;
};
/// A way out at a steep face.
struct CaveExit {
  std::int32_t node;
  Vec3d position, outward;  ///< on the surface; unit
};
struct Percolation {
  std::vector<CaveNode> nodes;                                ///< parents before children
  std::vector<std::pair<std::int32_t, std::int32_t>> merges;  ///< links where networks met
  std::vector<CaveExit> exits;
};

/// Seeds lie on the surface or in the rock of `field`. Pops the candidate of least rho + epsilon * random,
/// carves it if rho < rho_0, and pushes those points on its lower hemisphere whose Poisson sphere is free,
/// until the queue is empty or every seed has its number of points. Departures from the paper: a candidate
/// first moves to the least rho about it, and its order is by the mean rho of the way to it, so that ways
/// keep within soft beds and faults instead of crossing them. Springs on the surface are joined afterwards
/// to the nearest carved point above them, by the softest way down.
Percolation percolate(const field::CompiledField& field, const Ground& ground, const Entrances& entrances,
                      const PercolationSettings& settings, const PercolationSpace& space, Progress& progress);

}  // namespace tafoni::landforms::impl
