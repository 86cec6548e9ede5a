#pragma once
// What every reader of volumes promises of any bytes: finite samples in a memory that the file's size bounds,
// or one error of kind input.

#include <algorithm>
#include <iterator>

#include "fuzz.h"

#include "tafoni/core/parallel.h"
#include "tafoni/io/volume_file.h"

inline void check_volume(std::span<const std::byte> bytes, const std::string& name) {
  using namespace tafoni;
  // A copy of the exact size lets AddressSanitizer see any step beyond it.
  const std::vector<std::byte> copy(bytes.begin(), bytes.end());
  accepts([&] {
    const io::Volume volume = io::read_volume(copy, name);
    const Interval range = volume.grid.range(volume.grid.frame().box());
    require(std::isfinite(range.lo) && std::isfinite(range.hi) && std::isfinite(volume.origin.x));
    require(volume.grid.bytes() <= (std::uint64_t{400} << 20) + 2000 * copy.size());
  });
}

/// A slope with a step as a file; nothing where this build does not write the format.
inline std::string written_volume(const std::string& extension, tafoni::volume::Precision precision,
                                  tafoni::Vec3i size, float spread) {
  using namespace tafoni;
  set_thread_count(1);
  io::Volume volume{volume::ScalarGrid({{1, 2, 3}, 0.5, size}, -3, precision), {450000, 5500000, 100}, {}};
  volume.grid.edit(volume.grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int x = first.x + static_cast<int>(i);
      row[i] = x < 4 ? 3.0f : std::min(std::max(spread * static_cast<float>(20 - x - first.z), -3.0f), 3.0f);
    }
  });
  volume.grid.compact();
  const FuzzFolder folder;
  const std::filesystem::path path = folder / ("a." + extension);
  if (!accepts([&] { io::write_volume(path, volume); }, {ErrorKind::usage, ErrorKind::output})) return {};
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
