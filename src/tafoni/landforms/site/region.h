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

namespace impl {
class Outline;
}
class Region;

/// A region's weight as a control field in [0, 1], continuous for fade > 0: it rises from 0 at altitude
/// limits, boxes, rings, the rim of a mask and its pixels without data to the weight of the masks `fade`
/// metres inside them. Exactly 0 wherever the weight is 0; range() says so of whole boxes. Null for a null
/// region.
field::FunctionPtr as_function(const Region* region, double fade);

/// The intersection of the parts that are given. Weight in [0, 1]: 0 outside.
class Region {
 public:
  void limit_altitude(double lo, double hi);  ///< local z
  void limit_box(const Box3d& box);           ///< local
  void limit_polygon(const std::vector<Ring>& rings);
  void limit_mask(
      std::shared_ptr<const raster::Raster> mask);  ///< bilinear; values clamped to [0, 1]; NaN: 0
  double weight(Vec3d p) const;
  bool contains(Vec3d p) const { return weight(p) > 0; }
  /// Encloses the region in x and y; infinite where not limited.
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
