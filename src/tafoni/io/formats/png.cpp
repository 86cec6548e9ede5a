#include <algorithm>
#include <string>

#include <stb_image_write.h>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/pixels.h"

namespace tafoni::io::format_png {
namespace {

void write(AtomicFile& out, const raster::Image& image) {
  const bool opaque =
      std::ranges::all_of(image.values(), [](const std::array<std::uint8_t, 4>& p) { return p[3] == 255; });
  const int channels = opaque ? 3 : 4;
  const auto bytes = impl::interleave(image, channels);
  std::string png;
  if (!stbi_write_png_to_func(impl::append_to, &png, image.width(), image.height(), channels, bytes.data(),
                              image.width() * channels))
    fail(ErrorKind::output, "A picture of {} x {} pixels cannot be written as PNG.", image.width(),
         image.height());
  out.write(png);
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "png", .doc = "Pictures, 8-bit sRGB, lossless", .source = "[PNG]"},
      .extensions = {"png"},
      .write_image = write,
  };
  return type;
}

}  // namespace tafoni::io::format_png
