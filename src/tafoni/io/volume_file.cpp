#include "tafoni/io/volume_file.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/volume_chunks.h"

namespace tafoni::io {

void write_volume(const std::filesystem::path& path, const Volume& volume, Progress& progress) {
  const FormatType& format = format_of(path, Ability::write_volume);
  AtomicFile file(path);
  progress.begin("writing " + path.filename().string(), impl::chunk_count(volume.grid), "chunks");
  format.write_volume(file, volume, progress);
  file.commit();
  progress.end();
}

Volume read_volume(const std::filesystem::path& path, Progress& progress) {
  const FormatType& format = format_of(path, Ability::read_volume);
  const impl::MappedFile file(path);
  return format.read_volume(file.bytes(), path.string(), progress);
}

}  // namespace tafoni::io
