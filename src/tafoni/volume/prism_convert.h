#pragma once
// Prism-fields from heightfields, grids and fields, and as leaves of construction trees.

#include <limits>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/function.h"
#include "tafoni/raster/grid.h"
#include "tafoni/volume/prism_field.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {

/// Matter from elevation `bottom` to `top`, local metres, in every column.
PrismFields prism_box(const ColumnFrame& frame, double bottom, double top);

/// A column a pixel, from elevation `base` to the ground; none where the ground is no higher or there is no
/// data. Column (0, 0) is the south-west pixel. Throws Error{usage} for a raster without cells.
PrismFields prism_from(const raster::Raster& heights, double base);

/// A column a sample of the grid; tops and bottoms are the roots of its trilinear function there, exact to
/// float. Matter that the frame cuts ends at its lowest and highest samples.
PrismFields prism_from(const ScalarGrid& grid);

/// Of the field over `box`: columns on the lattice of `spacing`, looked at every `spacing` metres up; roots
/// then refined to a thousandth of it. Air and matter thinner than the spacing may be missed. What the box
/// cuts ends at the lattice planes around it. Throws as frame_over().
PrismFields prism_from(const field::CompiledField& field, const Box3d& box, double spacing,
                       Progress& progress = silent());

struct PrismLeafSettings {
  /// Values are limited to [-reach, reach] metres.
  double reach = 7.5;
  /// Matter that ends at this local elevation or lower goes on below without end.
  double floor = -std::numeric_limits<double>::infinity();
  /// Share of the columns' spacing over which values near the surface are averaged across; 0 averages none.
  /// [Boggus] ends matter at columns, and so rims in teeth and round shafts in stairs; at 0.7 they are
  /// gone, and with them sheets that are thinner than a quarter of the spacing.
  double rounding = 0;
};

/// A leaf for construction trees. Unless it is rounded, its zero set is the surface that
/// surface::polygonize() makes (with DeadPoints::triangles), to rounding of numbers. Its values are
/// first-order distances: of tops and bottoms the vertical distance over the slope's secant, which is the
/// distance to the plane of the triangle; of walls the distance to the wall, within one cell of it. Beyond a
/// cell from a wall and beside sharp edges they are only bounds.
field::FunctionPtr as_function(const PrismFields& fields, const PrismLeafSettings& settings = {});

}  // namespace tafoni::volume
