#pragma once
// Heightmaps without a header, as game engines and terrain programs exchange them.

#include <filesystem>
#include <memory>

#include "tafoni/io/dem.h"
#include "tafoni/io/impl/dem_source.h"

namespace tafoni::io::impl {

/// The heights of a file that is nothing but rows of numbers of 8, 16 or 32 bits (floats); null for any other
/// file. Square unless `options` give a size. A name that does not end in .raw, .r8, .r16, .raw16 or .r32
/// serves where no other format ends so, GDAL does not know the file, and its numbers are smooth. Throws
/// Error{input} when the size does not fit.
std::unique_ptr<DemSource> open_raw(const std::filesystem::path& path, const DemOptions& options);

}  // namespace tafoni::io::impl
