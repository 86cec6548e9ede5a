#pragma once
// Where a landform may act: any combination of altitude range, box, polygon and raster mask.

#include <memory>
#include <vector>

#include "tafoni/field/function.h"
#include "tafoni/math/vec.h"
#include "tafoni/raster/grid.h"

namespace tafoni::landforms {

/// A closed ring of a polygon; holes and islands by the even-odd rule. Local metres.
using Ring = std::vector<Vec2d>;

/// The intersection of the parts that are given. Weight in [0, 1]: 0 outside.
class Region {
 public:
  void limit_altitude(double lo, double hi);  ///< local z
  void limit_box(const Box3d& box);           ///< local
  void limit_polygon(std::vector<Ring> rings);
  void limit_mask(
      std::shared_ptr<const raster::Raster> mask);  ///< bilinear; values clamped to [0, 1]; NaN: 0
  double weight(Vec3d p) const;
  bool contains(Vec3d p) const { return weight(p) > 0; }
  /// Encloses the region in x and y; infinite where not limited.
  Box3d bounds() const;

 private:
  struct Altitude {
    double lo, hi;
  };
  std::vector<Altitude> altitudes_;
  std::vector<Box3d> boxes_;
  std::vector<std::vector<Ring>> polygons_;
  std::vector<std::shared_ptr<const raster::Raster>> masks_;
};

/// A region's weight as a control field that falls to 0 over `fade` metres inside its limits, so that what it
/// controls has no step there. Null for a null region.
field::FunctionPtr as_function(const Region* region, double fade);

}  // namespace tafoni::landforms
