#pragma once
// GRASS's grids of text: what GDAL reads otherwise than GRASS writes it.

#include <array>
#include <optional>
#include <string>

#include "tafoni/io/impl/pixel_runs.h"

namespace tafoni::io::impl {

struct GrassGrid {
  /// GDAL's six numbers, where the header has degrees, minutes and seconds, of which GDAL reads the degrees.
  std::optional<std::array<double, 6>> transform;
  bool null_is_word = false;  ///< of which GDAL makes a zero
  PixelRuns missing;          ///< where the word for null stands, or nan
};

/// `file` is as GDAL opens it, `name` for messages; `whole` where GDAL reads whole numbers alone. Throws
/// Error{input} where a word or a fraction stands in place of a height, and for edges that are not
/// understood.
GrassGrid read_grass_text(const std::string& file, const std::string& name, int width, int height,
                          bool whole);

}  // namespace tafoni::io::impl
