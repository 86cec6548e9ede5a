#pragma once
// Little-endian numbers in byte strings, and a checksum of them.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace tafoni::runtime::impl {

/// Four lanes, so that it runs at about the speed of memory. No defence against forgers.
inline std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t seed = 0) {
  constexpr std::uint64_t odd = 0x9e3779b97f4a7c15ull;
  std::uint64_t lane[4] = {seed + odd, seed ^ 0x6a09e667f3bcc909ull, seed + 0x3c6ef372fe94f82bull, ~seed};
  const auto step = [](std::uint64_t& l, std::uint64_t word) {
    l = (l ^ word) * odd;
    l ^= l >> 32;
  };
  const std::byte* p = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 32; left -= 32)
    for (std::uint64_t& l : lane) {
      std::uint64_t word;
      std::memcpy(&word, p, 8);
      step(l, word);
      p += 8;
    }
  for (; left > 0; --left, ++p) step(lane[0], std::to_integer<std::uint64_t>(*p));
  for (int i = 1; i < 4; ++i) step(lane[0], std::rotl(lane[i], 16 * i));
  step(lane[0], bytes.size());
  return lane[0];
}

static_assert(std::endian::native == std::endian::little, "bytes are stored as they lie in memory");

class ByteWriter {
 public:
  template <class T>
  void put(T value) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }
  /// How long a list is, in 4 bytes.
  template <class List>
  void put_count(const List& list) {
    put(static_cast<std::uint32_t>(list.size()));
  }
  std::vector<std::byte> bytes;
};

/// Past the end it gives zeros and is no longer good().
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : left_(bytes) {}
  template <class T>
  T get() {
    T value{};
    if (left_.size() < sizeof value) {
      good_ = false;
      left_ = {};
      return value;
    }
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  std::size_t left() const { return left_.size(); }
  /// All was there, and nothing is left over.
  bool done() const { return good_ && left_.empty(); }

 private:
  std::span<const std::byte> left_;
  bool good_ = true;
};

}  // namespace tafoni::runtime::impl
