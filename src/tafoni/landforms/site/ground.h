#pragma once
// What every generator asks of its site: where it may act, and how hard the rock is.

#include <span>

#include "tafoni/field/compiled.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/region.h"

namespace tafoni::landforms::impl {

class Ground {
 public:
  explicit Ground(const Site& site);

  const Site& site() const { return site_; }
  /// The raster's outline and the surface's range of heights grown by R, cut by the region; empty when
  /// nothing is left.
  const Box3d& box() const { return box_; }
  double pixel() const { return pixel_; }
  /// Whether a place is inside the raster, on real data, and in the region.
  bool usable(Vec3d p) const;
  /// Whether it also is farther than `margin` from the raster's outline and from missing data.
  bool usable(Vec3d p, double margin) const;
  /// The region's weight; 1 without a region.
  double weight(Vec3d p) const;
  /// rho in [0, 1]; 1/2 without a geology.
  double resistance(Vec3d p) const;
  void resistances(std::span<const Vec3d> points, std::span<float> out) const;
  /// Elevation of the raster, local metres.
  double height(double x, double y) const;

 private:
  bool on_data(double x, double y) const;

  const Site& site_;
  Box3d outline_, box_;
  double pixel_;
};

/// Where the site may be changed as a control field: the region's, 0 where data are missing; null for
/// everywhere.
field::FunctionPtr control_of(const Site& site, double fade);

}  // namespace tafoni::landforms::impl
