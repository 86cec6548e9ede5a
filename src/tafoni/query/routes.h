#pragma once
// Places to stand, and ways between them: what a walker can reach from a place, found by its own strides.

#include <cstdint>
#include <vector>

#include "tafoni/query/walker.h"

namespace tafoni::query {

struct RouteSettings {
  double spacing = 0.5;       ///< metres between places, along x and y
  std::size_t places = 4000;  ///< at most so many are looked for
};

/// The places that a walker reaches from `start` by strides to neighbours on a lattice of columns (multiples
/// of the spacing), each of which comes within a tenth of the spacing of its column. What is found does not
/// depend on threads.
class Routes {
 public:
  Routes(const Collider& ground, const WalkerSettings& walker, Vec3d start,
         const RouteSettings& settings = {});

  /// Feet; the first is the start, put on its column. Empty where one cannot stand there.
  const std::vector<Vec3d>& places() const { return places_; }
  /// Places from one to the other, both included, by the fewest strides; empty where there is no way.
  std::vector<Vec3d> way(std::size_t from, std::size_t to) const;

 private:
  std::vector<Vec3d> places_;
  std::vector<std::vector<std::uint32_t>> strides_;  ///< to which places one can go
};

/// Every place to stand in a column, from above, where the capsule fits. `above` and `below`: elevations to
/// look between. `roofed` keeps only places with rock above within that range.
std::vector<Vec3d> standing_places(const Collider& ground, const WalkerSettings& walker, double x, double y,
                                   double above, double below, bool roofed = false);

/// What came of a walk.
struct Walked {
  bool arrived = false;
  int moves = 0;
  double metres = 0;   ///< of the way
  double seconds = 0;  ///< of the walker's time
};
/// Drives the walker from place to place, at `speed` metres a second and `step` seconds a move; `each` is
/// called after every move. Gives up at a place that takes 8 times as long as it should.
Walked follow(const Collider& ground, Walker& walker, const std::vector<Vec3d>& way, double speed,
              double step, const std::function<void(const Walker&)>& each = {});

}  // namespace tafoni::query
