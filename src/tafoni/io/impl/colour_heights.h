#pragma once
// Pictures whose three colours are one height: grey ones, and the tiles of web maps.

#include <array>

#include "tafoni/io/dem.h"
#include "tafoni/io/impl/gdal.h"

namespace tafoni::io::impl {

/// Three bands of a dataset, the most significant first.
using ColourBands = std::array<GDALRasterBand*, 3>;

/// The red, green and blue bands of `dataset`; null ones where it has no three.
ColourBands colour_bands(GDALDataset& dataset);

enum class Colours { picture, grey, terrain_rgb, terrarium };

/// What the colours hold, judged from some rows. Web tiles are told by their ranges, which lie apart, and by
/// this: where one byte of a height ends the next takes over, as no colours of a photograph do.
Colours look_at_colours(const ColourBands& bands);

/// Reads three bands of bytes as heights in metres; NaN where all are 0, which marks what is missing.
/// `encoding` is terrain_rgb or terrarium. False when GDAL cannot read them.
bool read_colour_heights(const ColourBands& bands, HeightEncoding encoding, int x, int y, int w, int h,
                         double* out);

}  // namespace tafoni::io::impl
