#pragma once
// A digest says in 128 bits what a cached result depends on.

#include <bit>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>
#include <type_traits>

#include "tafoni/core/random.h"

namespace tafoni::scene::impl {

class Digest {
 public:
  Digest& add(std::uint64_t v) {
    a_ = hash_combine(a_, v);
    b_ = hash_combine(b_ ^ 0x5bd1e9955bd1e995ull, v + 0x9e3779b97f4a7c15ull);
    return *this;
  }
  Digest& add(double v) { return add(std::bit_cast<std::uint64_t>(v)); }
  Digest& add(std::string_view bytes);
  Digest& add(const Digest& other) { return add(other.a_).add(other.b_); }

  friend bool operator==(const Digest&, const Digest&) = default;
  friend auto operator<=>(const Digest&, const Digest&) = default;

 private:
  std::uint64_t a_ = 1, b_ = 2;
};

/// Digests of what files hold, together with the files that GDAL reads along with them (.tfw, .aux.xml, .dbf
/// …). A file is read again when its size or time differs, or when it was so young that a further change
/// might not show in its time. Of large files size, time and the first bytes count. A file that is not there
/// has a digest of its own.
class FileDigests {
 public:
  Digest of(const std::filesystem::path& file);

 private:
  struct Known {
    std::uintmax_t size = 0;
    std::filesystem::file_time_type time, read;
    Digest digest;
  };
  Digest one(const std::filesystem::path& file);
  std::map<std::filesystem::path, Known> known_;
};

}  // namespace tafoni::scene::impl
