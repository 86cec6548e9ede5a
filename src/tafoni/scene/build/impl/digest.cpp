// Two hashes of 64 bits, chained word by word. Files are read only where their size or time says that they
// may have changed, together with the side files that GDAL reads along with them.
#include "tafoni/scene/build/impl/digest.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace tafoni::scene::impl {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t read_whole = std::uint64_t{1} << 24;  // bytes

/// Whether GDAL may read `name` along with a file of this stem.
bool goes_with(std::string_view name, const std::string& stem) {
  static constexpr std::string_view endings[] = {".aux.xml", ".msk", ".ovr", ".tfw", ".wld", ".pgw",
                                                 ".jgw",     ".prj", ".hdr", ".dbf", ".shx", ".cpg"};
  if (!name.starts_with(stem + ".")) return false;
  name.remove_prefix(stem.size());
  return std::find(std::begin(endings), std::end(endings), name) != std::end(endings);
}

}  // namespace

Digest& Digest::add(std::string_view bytes) {
  std::size_t at = 0;
  for (; at + 8 <= bytes.size(); at += 8) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data() + at, 8);
    add(word);
  }
  std::uint64_t tail = 0;
  std::memcpy(&tail, bytes.data() + at, bytes.size() - at);
  return add(tail).add(static_cast<std::uint64_t>(bytes.size()));
}

Digest FileDigests::one(const fs::path& file) {
  using namespace std::chrono_literals;
  std::error_code code;
  const std::uintmax_t size = fs::file_size(file, code);
  if (code) return Digest().add(std::string_view("missing"));
  const auto time = fs::last_write_time(file, code);
  const auto found = known_.find(file);
  if (found != known_.end() && found->second.size == size && found->second.time == time &&
      found->second.read - time > 2s)
    return found->second.digest;

  const auto now = fs::file_time_type::clock::now();
  Digest digest;
  digest.add(std::uint64_t{size});
  std::string bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(size, read_whole)), '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  digest.add(std::string_view(bytes));
  if (size > read_whole) digest.add(static_cast<std::uint64_t>(time.time_since_epoch().count()));
  known_.insert_or_assign(file, Known{size, time, now, digest});
  return digest;
}

Digest FileDigests::of(const fs::path& file) {
  std::error_code code;
  std::vector<fs::path> parts;
  if (fs::is_directory(file, code)) {
    for (const auto& entry : fs::recursive_directory_iterator(file, code))
      if (entry.is_regular_file(code)) parts.push_back(entry.path());
  } else {
    const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
    const std::string name = file.filename().string();
    for (const auto& entry : fs::directory_iterator(folder, code)) {
      const std::string other = entry.path().filename().string();
      if (other != name && (goes_with(other, file.stem().string()) || goes_with(other, name)))
        parts.push_back(entry.path());
    }
  }
  std::sort(parts.begin(), parts.end());
  Digest digest = one(file);
  for (const fs::path& part : parts) digest.add(std::string_view(part.filename().native())).add(one(part));
  return digest;
}

}  // namespace tafoni::scene::impl
