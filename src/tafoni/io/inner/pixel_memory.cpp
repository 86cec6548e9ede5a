#include "tafoni/io/inner/pixel_memory.h"

#include <unistd.h>

#include "tafoni/core/error.h"

namespace tafoni::io::inner {
namespace {

namespace pixel_memory {
/// The share of the machine's memory that a raster may take, and the most pixels that ints count.
constexpr double share = 0.7, most_pixels = 2e9;
}  // namespace pixel_memory

}  // namespace

void check_pixels(double pixels, double copies, std::string_view name, std::string_view advice) {
  const double memory =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  const double needed = pixels * copies * sizeof(float);
  if (pixels < pixel_memory::most_pixels && needed < pixel_memory::share * memory) return;
  fail(ErrorKind::usage, "{}: {:.0f} million pixels need {:.0f} GB of memory; {}.", name, pixels / 1e6,
       needed / 1e9, advice);
}

}  // namespace tafoni::io::inner
