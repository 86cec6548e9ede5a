#pragma once
// One floating island: the rock between a piece of terrain and an inverted one, within a ragged outline
// [Paris19 §5.1].

#include <cstdint>

#include "tafoni/field/tree.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

struct Island {
  Vec3d middle;  ///< of the top, local
  double size;   ///< mean width, metres
  std::uint64_t seed;
};

/// Parameters of islands, as shares of an island's size unless said otherwise.
struct IslandSettings {
  double depth = 0.7;    ///< how deep the roots hang
  double relief = 0.12;  ///< height of the hills on top
  double roots = 0.7;    ///< in [0, 1]: how much the underside is split into roots
};

struct IslandTree {
  field::NodePtr tree;
  Box3d changed;  ///< encloses all that a union with the tree changes
};
IslandTree make_island(const Ground& ground, const Island& island, const IslandSettings& settings);

}  // namespace tafoni::landforms::impl
