#pragma once
// Whether a raster that a file asks for fits this machine.

#include <string_view>

namespace tafoni::io::inner {

/// Throws Error{usage} when `pixels` floats, `copies` times, do not fit this machine; its sentence ends with
/// `advice`.
void check_pixels(double pixels, double copies, std::string_view name, std::string_view advice);

}  // namespace tafoni::io::inner
