#pragma once
// From a file's own frame (degrees, feet, rotated, south-up) to a metric, north-up one.

#include <array>
#include <string>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/io/impl/dem_source.h"
#include "tafoni/raster/grid.h"

namespace tafoni::io::impl {

struct Frame {
  /// The transform of the file's pixels, in metres of `crs`, or in degrees and the like where `reproject`.
  std::array<double, 6> transform{};
  OGRSpatialReference crs;     ///< of `transform`; empty when unknown
  OGRSpatialReference target;  ///< metric; empty when unknown; `crs` unless `reproject`
  bool reproject = false;
  bool rotated = false;             ///< by other than quarter turns
  double pixel_x = 1, pixel_y = 1;  ///< metres on the ground along a row and a column, at the middle
  double degrees_wide = 0;  ///< of longitude that the window spans; 0 where the file is not in degrees
  std::vector<std::string> notes;
};

/// Decides how to bring `source` to metres. Of `options`: what says where it lies, and where to bring it.
Frame metric_frame(const DemSource& source, const std::array<int, 4>& window, const DemOptions& options);

/// Puts a grid that covers `transform` (six numbers as GDAL's, in metres) upright by flips and quarter turns;
/// `transform` has no other rotation.
raster::Raster upright(raster::Grid<float>&& grid, const std::array<double, 6>& transform);

/// Warps by chunks onto the target CRS, bicubic. `pixel` in metres; NaN where nothing lies beneath.
raster::Raster warp(raster::Grid<float>& grid, const std::array<double, 6>& transform, const Frame& frame,
                    double pixel, const std::string& name, Progress& progress);

/// Why a file in degrees that goes about most of the earth cannot be read whole, and what to do.
std::string why_too_wide(DemSource& source, double degrees);

/// Throws Error{usage} when `pixels` floats, `copies` times, do not fit this machine.
void check_memory(double pixels, double copies, const std::string& name);

}  // namespace tafoni::io::impl
