#pragma once
// What the program knows of a solid of the shape grammar [Zawadzki]: a signed distance, and the places
// where it can be joined to others.
//
// The solids of the paper are quadrics like x^2 + y^2 + z^2 - r, whose values are no lengths, so that a morph
// weighs large solids more than small ones. Here every solid is a true distance in metres, positive inside.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tafoni/core/registry.h"
#include "tafoni/math/vec.h"

namespace tafoni::grammar {

/// A place on a surface where another shape can be joined [Zawadzki def. 4].
struct Bond {
  Vec3d point;
  Vec3d direction;  ///< unit, outward; zero glues with any
};

/// Immutable, in a frame of its own about its middle.
class Solid {
 public:
  virtual ~Solid() = default;
  /// Metres to the surface, positive inside: between two points it changes by no more than they are apart.
  virtual double distance(Vec3d p) const = 0;
  /// Encloses what is inside; empty for a solid that holds nothing.
  virtual Box3d bounds() const = 0;
  virtual std::vector<Bond> bonds() const = 0;
};
using SolidPtr = std::shared_ptr<const Solid>;

struct SolidType {
  Declaration about = {};
  /// Throws Error{usage} for sizes that are out of range.
  SolidPtr (*make)(const Values& sizes) = nullptr;
  /// The sizes of one that fills a box of these half widths as far as its shape allows.
  Values (*fit)(Vec3d half) = nullptr;
};

/// Every solid, sorted by name; the table is written by CMake from the folder's files: solids/NAME.cpp
/// defines `const SolidType& declaration()` in its namespace `solid_NAME`.
std::span<const SolidType* const> all_solids();
/// Throws Error{usage} naming the nearest known one.
const SolidType& find_solid(std::string_view name);

}  // namespace tafoni::grammar
