// A node's values begin with a byte that says how inactive ones are told: all are the background, or its
// negative, or one of two that follow, chosen by a mask. Then come the active ones, or all. What is
// compressed begins with its length; none or a negative one means that it is not, since it would not shrink.
// Of blosc's codecs this is LZ4, which is what OpenVDB writes; its blocks are taken apart here, so that no
// other code than LZ4's own, which is made for that, sees a stranger's bytes.

#include "tafoni/io/impl/vdb_values.h"

#include <algorithm>
#include <limits>

#include <lz4.h>
#include <zlib.h>

#include "tafoni/core/error.h"
#include "tafoni/math/half.h"

namespace tafoni::io::impl {
namespace {

/// What the byte before a node's values says of the inactive ones.
enum Inactive : std::int8_t {
  background_only,
  negative_only,
  one_value,
  either_background,     ///< the mask chooses between -background and background
  value_or_background,   ///< the mask chooses between one value and the background
  either_of_two_values,  ///< the mask chooses
  all_kept,              ///< they stand between the active ones
};

struct NodeHead {
  float values[2];  ///< of inactive entries whose bit in `choice` is off and on
  VdbMask choice;   ///< empty: none is on
  std::size_t kept;
};

NodeHead read_head(VdbBytes& in, const VdbCoding& coding, VdbMask on) {
  const auto how = in.get<std::int8_t>();
  if (how < background_only || how > all_kept) in.damaged("a node says what cannot be");
  NodeHead head{{how == background_only ? coding.background : -coding.background, coding.background}, {}, 0};
  if (how == one_value || how == value_or_background || how == either_of_two_values)
    head.values[0] = in.get<float>();
  if (how == either_of_two_values) head.values[1] = in.get<float>();
  if (how == either_background || how == value_or_background || how == either_of_two_values)
    head.choice = in.take(on.size());
  const bool sparse = (coding.flags & VdbCoding::active_mask) && how != all_kept;
  head.kept = sparse ? count_on(on) : 8 * on.size();
  return head;
}

/// The bytes of `count` kept values as the file has them, which are packed where `packed` says so.
std::span<const std::byte> take_values(VdbBytes& in, const VdbCoding& coding, std::size_t count,
                                       bool* packed) {
  const std::uint64_t plain = count * (coding.half ? 2 : 4);
  *packed = false;
  // Of no halves not even the length is written.
  if (!(coding.flags & (VdbCoding::zip | VdbCoding::blosc)) || (coding.half && count == 0))
    return in.take(plain);
  const auto length = in.get<std::int64_t>();
  if (length <= 0) {
    if (length != -static_cast<std::int64_t>(plain)) in.damaged("a node has not as many values as it says");
    return in.take(plain);
  }
  *packed = true;
  return in.take(static_cast<std::uint64_t>(length));
}

/// Exactly out.size() bytes; false when they are not in `in`.
bool unzip(std::span<const std::byte> in, std::span<std::byte> out) {
  uLongf size = out.size();
  return uncompress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(in.data()),
                    in.size()) == Z_OK &&
         size == out.size();
}

/// Bytes of numbers, sorted by their place in the number, back into numbers.
void unshuffle(std::span<const std::byte> in, std::size_t size_of_number, std::span<std::byte> out) {
  const std::size_t n = in.size() / size_of_number;
  for (std::size_t b = 0; b < size_of_number; ++b)
    for (std::size_t i = 0; i < n; ++i) out[i * size_of_number + b] = in[b * n + i];
  std::copy(in.begin() + n * size_of_number, in.end(), out.begin() + n * size_of_number);
}

/// A chunk of blosc: 16 bytes of header, where the blocks begin, and the blocks, each of one stream or of
/// one for every byte of a number.
class Blosc {
 public:
  explicit Blosc(std::span<const std::byte> in) : in_(in) {}

  bool unpack(std::span<std::byte> out) {
    if (in_.size() < header_bytes || number(4) != out.size() || number(12) != in_.size()) return false;
    flags_ = std::to_integer<unsigned>(in_[2]);
    number_size_ = std::to_integer<std::size_t>(in_[3]);
    if (flags_ & copied) {
      if (in_.size() - header_bytes != out.size()) return false;
      std::copy(in_.begin() + header_bytes, in_.end(), out.begin());
      return true;
    }
    const std::uint64_t block = number(8);
    if (flags_ >> codec_shift != lz4 || (flags_ & bits_shuffled) || number_size_ == 0 || block == 0 ||
        block > out.size())
      return false;
    const std::uint64_t blocks = (out.size() + block - 1) / block;
    if (blocks > (in_.size() - header_bytes) / 4) return false;
    for (std::uint64_t i = 0; i < blocks; ++i)
      if (!unpack_block(number(header_bytes + 4 * i), block,
                        out.subspan(i * block, std::min<std::uint64_t>(block, out.size() - i * block))))
        return false;
    return true;
  }

 private:
  static constexpr std::size_t header_bytes = 16;
  static constexpr unsigned shuffled = 1, copied = 2, bits_shuffled = 4, whole = 16, codec_shift = 5, lz4 = 1;
  // Blocks of less, and numbers of more bytes, were never split, also before there was a bit for it.
  static constexpr std::size_t least_split = 128, most_splits = 16;

  std::uint32_t number(std::size_t at) const { return load<std::uint32_t>(in_, at); }

  bool unpack_block(std::uint64_t at, std::uint64_t block, std::span<std::byte> out) {
    const bool reorder = (flags_ & shuffled) && number_size_ > 1;
    buffer_.resize(reorder ? out.size() : 0);
    const std::span<std::byte> to = reorder ? std::span<std::byte>(buffer_) : out;
    const bool split = !(flags_ & whole) && out.size() == block && number_size_ <= most_splits &&
                       block / number_size_ >= least_split;
    const std::size_t streams = split ? number_size_ : 1, size = out.size() / streams;
    if (size * streams != out.size()) return false;
    for (std::size_t i = 0; i < streams; ++i) {
      if (at > in_.size() - 4) return false;
      const std::uint64_t packed = number(at);
      at += 4;
      if (packed > in_.size() - at || !unpack_stream(in_.subspan(at, packed), to.subspan(i * size, size)))
        return false;
      at += packed;
    }
    if (reorder) unshuffle(buffer_, number_size_, out);
    return true;
  }

  static bool unpack_stream(std::span<const std::byte> in, std::span<std::byte> out) {
    if (in.size() == out.size()) {
      std::copy(in.begin(), in.end(), out.begin());
      return true;
    }
    constexpr std::size_t most = std::numeric_limits<int>::max();
    if (in.size() > most || out.size() > most) return false;
    return LZ4_decompress_safe(reinterpret_cast<const char*>(in.data()), reinterpret_cast<char*>(out.data()),
                               static_cast<int>(in.size()),
                               static_cast<int>(out.size())) == static_cast<int>(out.size());
  }

  std::span<const std::byte> in_;
  unsigned flags_ = 0;
  std::size_t number_size_ = 0;
  std::vector<std::byte> buffer_;
};

/// The kept values as they are in memory: floats or halves.
template <class T>
std::vector<T> unpacked_values(VdbBytes& in, const VdbCoding& coding, std::size_t count) {
  bool packed = false;
  const auto bytes = take_values(in, coding, count, &packed);
  std::vector<T> out(count);
  const auto to = std::as_writable_bytes(std::span(out));
  if (!packed)
    std::copy(bytes.begin(), bytes.end(), to.begin());
  else if (!(coding.flags & VdbCoding::blosc ? Blosc(bytes).unpack(to) : unzip(bytes, to)))
    in.damaged("the values of a node cannot be unpacked");
  return out;
}

}  // namespace

std::span<const std::byte> VdbBytes::take(std::uint64_t count) {
  if (count > left()) damaged("it is cut off");
  const auto out = bytes_.subspan(at_, count);
  at_ += count;
  return out;
}

void VdbBytes::seek(std::uint64_t position) {
  if (position > bytes_.size()) damaged("it is cut off");
  at_ = position;
}

void VdbBytes::damaged(std::string_view what) const {
  fail(ErrorKind::input, "{}: the file is damaged: {}; write it again.", file_, what);
}

int count_on(VdbMask mask) {
  int out = 0;
  for (std::size_t at = 0; at < mask.size(); at += sizeof(std::uint64_t))
    out += std::popcount(load<std::uint64_t>(mask, at));
  return out;
}

void skip_values(VdbBytes& in, const VdbCoding& coding, VdbMask on) {
  bool packed = false;
  take_values(in, coding, read_head(in, coding, on).kept, &packed);
}

void read_values(VdbBytes& in, const VdbCoding& coding, VdbMask on, std::span<float> out) {
  const NodeHead head = read_head(in, coding, on);
  std::vector<float> kept;
  if (coding.half) {
    kept.resize(head.kept);
    from_half(unpacked_values<std::uint16_t>(in, coding, head.kept).data(), head.kept, kept.data());
  } else {
    kept = unpacked_values<float>(in, coding, head.kept);
  }
  if (head.kept == out.size()) {
    std::copy(kept.begin(), kept.end(), out.begin());
    return;
  }
  std::fill(out.begin(), out.end(), head.values[0]);
  each_on(head.choice, [&](std::size_t i) { out[i] = head.values[1]; });
  auto next = kept.begin();
  each_on(on, [&](std::size_t i) { out[i] = *next++; });
}

}  // namespace tafoni::io::impl
