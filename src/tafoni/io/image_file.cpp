#include "tafoni/io/image_file.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"

namespace tafoni::io {

void write_image(const std::filesystem::path& path, const raster::Image& image) {
  const FormatType& format = format_of(path, Ability::write_image);
  if (image.empty())
    fail(ErrorKind::output, "{}: the picture has no pixels, so there is nothing to write.", path.string());
  AtomicFile file(path);
  format.write_image(file, image);
  file.commit();
}

}  // namespace tafoni::io
