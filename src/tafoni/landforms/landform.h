#pragma once
// What the program knows of a landform generator: a declaration and one pure function.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/core/registry.h"
#include "tafoni/field/tree.h"
#include "tafoni/geology/geology.h"
#include "tafoni/landforms/facts.h"
#include "tafoni/raster/grid.h"

namespace tafoni::landforms {

class Region;

/// All a generator may look at. Positions are local; elevations in parameters are world elevations, so local
/// z = elevation - origin.z.
struct Site {
  Vec3d origin;                                       ///< world position of local zero
  std::shared_ptr<const raster::Raster> heights;      ///< local frame, filled where data was missing
  const raster::Grid<std::uint8_t>* valid = nullptr;  ///< 1 where heights are real data; null: everywhere
  double influence = 15, amplitude = 7.5;             ///< R and T of the terrain
  field::NodePtr terrain;                             ///< the tree so far, earlier layers included
  geology::GeologyPtr geology;                        ///< null: half resistant everywhere
  const Region* region = nullptr;                     ///< where the landform may act; null: everywhere
  std::vector<Vec3d> points;                          ///< user's seeds, local
  std::uint64_t seed = 0;
};

/// What a generator made. The tree that the next layer meets is
/// blend({reshape ? reshape(tree) : tree, nodes...}).
struct Result {
  /// A change of the tree that is more than a sum: a union with a solid, a warp, an erosion node. Pure.
  std::function<field::NodePtr(field::NodePtr)> reshape;
  Box3d reshaped;  ///< local; outside of it reshape() changes no value. Empty: nothing reshaped
  /// Local z below which the surface stays where it is, though values may change there; where it is not told,
  /// that of `reshaped` and the nodes.
  std::optional<double> lowest;
  std::vector<field::NodePtr> nodes;  ///< blended, in this order
  Facts facts;                        ///< what reports tell of it
};

/// Local z below which the surface stays where it was; minus infinity where that is not known.
double lowest_change(const Result& result);

/// The tree with the landform on it.
field::NodePtr apply_to(const field::NodePtr& tree, const Result& result);

struct LandformType {
  Declaration about = {};
  /// `values` hold only what differs from the defaults; already checked.
  Result (*generate)(const Site&, const Values&, Progress&) = nullptr;
};

/// Every landform, sorted by name; the table is written by CMake from the folders: NAME/NAME.cpp defines
/// `const LandformType& declaration()` in its namespace `landform_NAME` (with '-' as '_').
std::span<const LandformType* const> all_landforms();
/// Throws Error{usage} naming the nearest known one.
const LandformType& find_landform(std::string_view name);

}  // namespace tafoni::landforms
