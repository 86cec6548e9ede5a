#pragma once
// How OpenVDB's files keep numbers: steps through their bytes, each of which is checked, and the values of a
// node, of which those that are told by a mask may be left out, and which may be compressed by zip or blosc.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tafoni/io/impl/reading.h"

namespace tafoni::io::impl {

class VdbBytes {
 public:
  VdbBytes(std::span<const std::byte> bytes, std::string_view file) : bytes_(bytes), file_(file) {}

  std::string_view file() const { return file_; }
  std::size_t position() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  /// The next `count` bytes. Throws Error{input} where the file ends before.
  std::span<const std::byte> take(std::uint64_t count);
  template <class T>
  T get() {
    return load<T>(take(sizeof(T)), 0);
  }
  /// Four bytes of length, and as many bytes.
  std::string_view text() { return as_text(take(get<std::uint32_t>())); }
  void seek(std::uint64_t position);
  [[noreturn]] void damaged(std::string_view what) const;

 private:
  std::span<const std::byte> bytes_;
  std::string_view file_;
  std::size_t at_ = 0;
};

/// One bit an entry of a node; a multiple of 8 bytes.
using VdbMask = std::span<const std::byte>;

inline bool is_on(VdbMask mask, std::size_t i) {
  return (std::to_integer<unsigned>(mask[i / 8]) >> (i % 8) & 1) != 0;
}
int count_on(VdbMask mask);
/// Calls f(i) for each entry that is on, in their order. Most masks are zeros nearly all over.
template <class F>
void each_on(VdbMask mask, const F& f) {
  for (std::size_t at = 0; at < mask.size(); at += sizeof(std::uint64_t))
    for (auto left = load<std::uint64_t>(mask, at); left != 0; left &= left - 1)
      f(8 * at + std::countr_zero(left));
}

/// How the values of a grid's nodes are kept.
struct VdbCoding {
  static constexpr std::uint32_t zip = 1, active_mask = 2, blosc = 4;  ///< of `flags`
  std::uint32_t flags = 0;
  bool half = false;
  float background = 0;
};

/// Steps over the values of a node whose active entries are `on`.
void skip_values(VdbBytes& in, const VdbCoding& coding, VdbMask on);
/// Reads them; as many as `on` has bits.
void read_values(VdbBytes& in, const VdbCoding& coding, VdbMask on, std::span<float> out);

}  // namespace tafoni::io::impl
