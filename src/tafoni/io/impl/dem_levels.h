#pragma once
// The levels of an elevation file: windows of it averaged down, from an overview where that can be trusted.

#include <array>

#include "tafoni/core/progress.h"
#include "tafoni/io/impl/dem_source.h"
#include "tafoni/raster/grid.h"

namespace tafoni::io::impl {

/// A window of a file brought to fewer pixels.
struct Reading {
  raster::Grid<float> heights;
  /// Metres by which an overview that would have served is off the file's own pixels; 0 where none is. The
  /// heights are averages of the pixels then.
  double overviews_off = 0;
};

/// Area averages of the file's pixels of a window: pixel (i, j) covers fx by fy of the file's pixels.
/// Reads by strips, large windows from the coarsest overview that is fine enough and holds area averages.
Reading read_window(DemSource& source, const std::array<int, 4>& window, double fx, double fy, int width,
                    int height, Progress& progress);

}  // namespace tafoni::io::impl
