#pragma once
// The parts of a region as control fields: factors in [0, 1] whose ranges over boxes are known.

#include <memory>
#include <vector>

#include "tafoni/field/function.h"
#include "tafoni/landforms/site/outline.h"
#include "tafoni/raster/grid.h"

namespace tafoni::landforms::impl {

struct Range {
  double lo, hi;
};

/// A raster that is bilinear between its pixels' centres, is continued outside by the nearest pixel, and
/// knows its ranges over boxes.
class RangedRaster {
 public:
  /// Values must be finite.
  RangedRaster(raster::Grid<float> values, const raster::Placement& placement);
  double at(Vec3d p) const;
  Range over(const Box3d& box) const;

 private:
  raster::Placement placement_;
  raster::Grid<float> values_;
  raster::Grid<Range> tiles_;
};

class Control {
 public:
  virtual ~Control() = default;
  virtual double at(Vec3d p) const = 0;
  virtual Range over(const Box3d& box) const = 0;
};
using ControlPtr = std::unique_ptr<const Control>;

/// A control that is 0 outside of the box and 1 from `fade` metres inside of it on; limits may be infinite.
ControlPtr box_control(const Box3d& box, double fade);
/// The same for a polygon, by the distance to its rings.
ControlPtr outline_control(std::shared_ptr<const Outline> outline, double fade);
/// The mask's values, bilinear between the pixels' centres and clamped to [0, 1]. Pixels without data count
/// as 0, and so do their neighbours, so that nothing is left of the mask where the nearest pixel has no data.
ControlPtr mask_control(const raster::Raster& mask);

/// The product of all parts; 1 for none at all.
field::FunctionPtr product(std::vector<ControlPtr> parts);

}  // namespace tafoni::landforms::impl
