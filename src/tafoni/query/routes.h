#pragma once
// Places to stand, and ways between them: what a walker can reach from a place, found by its own strides.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tafoni/query/walker.h"

namespace tafoni::query {

struct RouteSettings {
  double spacing = 0.5;       ///< metres between places, along x and y
  double move = 0.15;         ///< metres that a walker goes at once
  std::size_t places = 4000;  ///< at most so many are looked for
};

/// The places that a walker reaches from `start`, by walking straight to neighbours on a lattice of columns
/// (multiples of the spacing) without falling. Of several walkers, all must manage each stretch; places are
/// those of the first. What is found does not depend on threads.
class Routes {
 public:
  Routes(const Collider& ground, std::span<const WalkerSettings> walkers, Vec3d start,
         const RouteSettings& settings = {});

  const RouteSettings& settings() const { return settings_; }
  /// Feet; the first is the start, put on its column. Empty where one cannot stand there.
  const std::vector<Vec3d>& places() const { return places_; }
  /// A stretch between places beside each other, by their numbers.
  struct Stretch {
    std::uint32_t from = 0, to = 0;
    friend bool operator==(Stretch, Stretch) = default;
  };
  /// The places from one to the other, both included, over the fewest places and none of the stretches that
  /// are closed; empty where there is no way.
  std::vector<std::uint32_t> path(std::size_t from, std::size_t to,
                                  std::span<const Stretch> closed = {}) const;
  /// The feet there.
  std::vector<Vec3d> way(std::span<const std::uint32_t> path) const;
  /// The place nearest to the feet of those within one and a half spacings of them along x and y and two
  /// steps in height, `without` some; places().size() where there is none.
  std::size_t nearest(Vec3d feet, std::span<const std::size_t> without = {}) const;

 private:
  RouteSettings settings_;
  double step_ = 0;
  std::vector<Vec3d> places_;
  std::vector<std::vector<std::uint32_t>> next_;  ///< to which places one can go
};

/// Every place to stand in a column, from above, where the capsule fits. `above` and `below`: elevations to
/// look between. `roofed` keeps only places with rock above within that range.
std::vector<Vec3d> standing_places(const Collider& ground, const WalkerSettings& walker, double x, double y,
                                   double above, double below, bool roofed = false);

/// What came of a walk.
struct Walked {
  bool arrived = false;
  int moves = 0;
  std::size_t reached = 0;  ///< place of the way that it came to last
  double metres = 0;        ///< of the way, as far as that
  double seconds = 0;       ///< of the walker's time
};
/// Drives the walker along a way, `seconds` a move of at most `move` metres; `each` is called after
/// every move. Gives up at a place that takes three times as many moves as it should.
Walked follow(const Collider& ground, Walker& walker, const std::vector<Vec3d>& way, double move,
              double seconds, const std::function<void(const Walker&)>& each = {});

/// The same by the shortest way between two places; where it cannot go on or gets off, by a new way from the
/// nearest place without that stretch, at most `tries` ways.
Walked find_way(const Collider& ground, Walker& walker, const Routes& routes, std::size_t from,
                std::size_t to, double seconds, const std::function<void(const Walker&)>& each = {},
                int tries = 10);

}  // namespace tafoni::query
