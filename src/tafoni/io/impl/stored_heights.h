#pragma once
// What the numbers of an elevation file mean where it does not say so itself.

#include <optional>
#include <string>
#include <vector>

#include "tafoni/io/dem.h"
#include "tafoni/io/impl/dem_source.h"

namespace tafoni::io::impl {

/// Sets the scale and offset of `source`, and its notes on them: what the options say, else depths upside
/// down, an engine's heightmap, or numbers as they stand.
void interpret(DemSource& source, const DemOptions& options);

/// Why a band holds depths, counted positive downwards, by what its file says of it.
std::optional<Depths> depths_of(GDALDataset& dataset, GDALRasterBand& band);

/// Some `most` of `height` rows, evenly spread.
std::vector<int> spread_rows(int height, int most);

}  // namespace tafoni::io::impl
