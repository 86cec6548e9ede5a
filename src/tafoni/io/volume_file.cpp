#include "tafoni/io/volume_file.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/volume_chunks.h"

namespace tafoni::io {

void write_volume(const std::filesystem::path& path, const Volume& volume, Progress& progress) {
  const FormatType& format = format_of(path, Ability::write_volume);
  AtomicFile file(path);
  progress.begin("writing " + path.filename().string(), impl::Chunks(volume.grid.frame()).count(), "chunks");
  format.write_volume(file, volume, progress);
  file.commit();
  progress.end();
}

Volume read_volume(const std::filesystem::path& path, Progress& progress) {
  const FormatType& format = format_of(path, Ability::read_volume);
  const impl::MappedFile file(path);
  return impl::read_samples(format.open_volume(file.bytes(), path.string()), path.string(),
                            file.bytes().size(), progress);
}

Volume read_volume(std::span<const std::byte> bytes, const std::filesystem::path& file, Progress& progress) {
  const FormatType& format = format_of(file, Ability::read_volume);
  return impl::read_samples(format.open_volume(bytes, file.string()), file.string(), bytes.size(), progress);
}

VolumeInfo inspect_volume(const std::filesystem::path& path, Progress& progress) {
  const FormatType& format = format_of(path, Ability::read_volume);
  const impl::MappedFile file(path);
  return impl::look_at_samples(format.open_volume(file.bytes(), path.string()), path.string(),
                               file.bytes().size(), progress);
}

}  // namespace tafoni::io
