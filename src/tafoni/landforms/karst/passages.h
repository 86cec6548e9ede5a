#pragma once
// From the links of a percolated network to passages: how wide they are, where they wind, what is carved.

#include <cstdint>
#include <vector>

#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
#include "tafoni/landforms/karst/percolation.h"
#include "tafoni/landforms/karst/size.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// Parameters of karst.
struct PassageSettings {
  double beta = 0.2;        ///< effect on the most resistant rock
  double threshold = 0.12;  ///< dead ends whose effect is smaller are left out
  double roughness = 0.5;   ///< strength of the unevenness of the walls
  double winding = 0.5;     ///< how far passages wind off the straight line
  double chambers = 0.5;    ///< how often rooms break out, 0 to 1
};

/// Distance between the places of a passage, in radii of a middling one.
inline constexpr double place_step = 0.35;

/// One way through the rock, as a line of places about place_step apart.
struct Passage {
  std::vector<Vec3d> line;
  std::vector<double> radius;  ///< open, one a place
  std::int32_t network = 0;
};

/// A room around a place of a passage.
struct Chamber {
  Vec3d center;
  double radius;
};

struct CaveSystem {
  std::vector<Passage> passages;
  std::vector<Chamber> chambers;
  std::vector<Vec3d> entrances;  ///< where passages meet the surface
  std::vector<Vec3d> swallets;   ///< those among them that drink water from above: a doline opens there
  int networks = 0;
  double length = 0;  ///< metres
};

CaveSystem make_passages(const field::CompiledField& field, const Ground& ground,
                         const Percolation& percolation, const CaveSize& size,
                         const PassageSettings& settings, std::uint64_t seed);

/// Point primitives that open the passages, the rooms and the dolines. Passages are broad under hard beds,
/// have a slot cut into their floor here and there, and grooves along soft beds; rooms have roofs that follow
/// the bedding, stepped towards the walls.
field::NodePtr carve_passages(const CaveSystem& caves, const Ground& ground, const CaveSize& size,
                              const PassageSettings& settings, std::uint64_t seed);

/// For each network whether all its passages are open in `field` from end to end.
std::vector<bool> open_networks(const field::CompiledField& field, const CaveSystem& caves);

}  // namespace tafoni::landforms::impl
