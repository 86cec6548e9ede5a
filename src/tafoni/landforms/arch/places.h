#pragma once
// Where arches and bridges may be: a search over the terrain's faces that judges every place by its rock, and
// what follows from the parameters for whatever is built there.

#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/landforms/arch/openings.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

struct ArchParams {
  std::int64_t count = 6;
  double size = 0;       ///< metres: greatest height of an opening
  double thickness = 0;  ///< metres of the thickest wall that may be pierced
  double roof = 0;       ///< metres of rock that are left above an opening, at least
  double slope = 40;     ///< degrees from which ground is a face
  bool potholes = true;
  std::int64_t bridges = 0;
  double span = 0;        ///< metres of the longest bridge
  double weakness = 0.5;  ///< how much wider openings are in soft rock
  double roughness = 0.5;
};
/// The parameters with zeros replaced by what suits the terrain's pixels. All that follows wants these.
ArchParams with_defaults(ArchParams p, const Ground& ground);

/// Metres from sample to sample of whatever line is looked along.
inline double arch_step(const ArchParams& p) {
  return p.size / 16;
}

/// A place where something may be built.
template <class T>
struct Found {
  double merit;
  T what;
};

/// Each list has the best places first.
struct ArchPlaces {
  std::vector<Found<Window>> fins;    ///< thin walls
  std::vector<Found<Window>> cliffs;  ///< rims with room for a shaft behind them
  std::vector<Found<Bridge>> gaps;    ///< between opposite faces
};
/// `standing`: how many bridges there are already.
ArchPlaces find_arch_places(const Ground& ground, const field::CompiledField& field, const ArchParams& p,
                            std::size_t standing, Progress& progress);

/// The rock of bridges (sign 1: hard beds stand out) or of openings (-1: they are wider in soft beds).
RockTexture arch_texture(const Ground& ground, const ArchParams& p, double sign);

/// A bridge from a to b; the `index`th of all, for how it winds.
Bridge plan_bridge(const Ground& ground, const ArchParams& p, Vec3d a, Vec3d b, std::size_t index);

}  // namespace tafoni::landforms::impl
