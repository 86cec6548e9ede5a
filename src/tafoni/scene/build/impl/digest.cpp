// Two hashes of 64 bits, chained word by word. Files are read only where their size or time says that they
// may have changed, together with the side files that GDAL reads along with them.
#include "tafoni/scene/build/impl/digest.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <string>

#include "tafoni/io/inner/data_files.h"

namespace tafoni::scene::impl {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t read_whole = std::uint64_t{1} << 24;  // bytes

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
  Digest digest;
  for (const fs::path& part : io::data_files(file))
    digest.add(std::string_view(part.filename().native())).add(one(part));
  return digest;
}

}  // namespace tafoni::scene::impl
