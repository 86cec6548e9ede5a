#pragma once
// Where a landform may act: any combination of altitude range, box, polygon and raster mask.

#include <memory>
#include <vector>

#include "tafoni/field/function.h"
#include "tafoni/math/vec.h"
#include "tafoni/raster/grid.h"

namespace tafoni::landforms {

/// A closed ring of a polygon in local metres. Holes and islands follow by the even-odd rule.
using Ring = std::vector<Vec2d>;

namespace impl {
class Outline;
}
class Region;

/// A region's weight as a control field in [0, 1], continuous for fade > 0: it rises from 0 at altitude
/// limits, boxes, rings, the rim of a mask and its pixels without data to the weight of the masks `fade`
/// metres inside them. It is exactly 0 wherever the weight is 0, and range() says so of whole boxes. Null for
/// a null region.
field::FunctionPtr as_function(const Region* region, double fade);

/// The intersection of the parts that are given, with a weight in [0, 1] that is 0 outside.
class Region {
 public:
  void limit_altitude(double lo, double hi);  ///< local z
  void limit_box(const Box3d& box);           ///< local
  void limit_polygon(const std::vector<Ring>& rings);
  /// The mask is bilinear, its values are clamped to [0, 1], and NaN counts as 0.
  void limit_mask(std::shared_ptr<const raster::Raster> mask);
  double weight(Vec3d p) const;
  bool contains(Vec3d p) const { return weight(p) > 0; }
  /// A box that encloses the region; infinite where it is not limited.
  Box3d bounds() const;

 private:
  friend field::FunctionPtr as_function(const Region*, double);
  struct Altitude {
    double lo, hi;
  };
  std::vector<Altitude> altitudes_;
  std::vector<Box3d> boxes_;
  std::vector<std::shared_ptr<const impl::Outline>> polygons_;
  std::vector<std::shared_ptr<const raster::Raster>> masks_;
};

}  // namespace tafoni::landforms
