// Tafoni's own file of a volume. Little-endian:
//   0  "TAFONVOL"
//   8  u32 version, u32 bytes a sample (4 or 2)
//  16  f64 x 3 world position of local zero, f64 x 3 position of sample (0, 0, 0), f64 spacing
//  72  i32 x 3 samples a side, u32 samples a side of a chunk
//  88  u64 bytes of the text, u64 bytes of the chunk table as stored
// 104  u64 hash of all that stands before the chunks' data, without itself
// 112  the text: JSON of name, crs and generator
//      the table, compressed: for each chunk, x fastest, u32 bytes of its data, and u32 hash of them; where
//      all samples are alike 0 and their f32 value
//      the data of the chunks that are not alike, in the same order
// A chunk's samples are taken as integers in the order of their values, differenced along x, y and z, split
// into planes of bytes, and compressed by zstd. The hashes are FNV-1a, in which each byte's step is one to
// one, so that one changed byte is always noticed.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <zstd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/json_text.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/volume_chunks.h"
#include "tafoni/io/impl/writing.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/math/half.h"

namespace tafoni::io::format_tvol {
namespace {

using volume::Precision;
using volume::ScalarGrid;

constexpr std::string_view magic = "TAFONVOL";
constexpr std::uint32_t version = 2;
constexpr std::size_t hash_at = 104, header_bytes = 112;
constexpr int level = 3;

struct TableEntry {
  std::uint32_t bytes;
  std::uint32_t what;  ///< the data's hash, or the value's bits
};
static_assert(sizeof(TableEntry) == 8);

std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t hash = 0xcbf29ce484222325ull) {
  for (const std::byte b : bytes) hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3ull;
  return hash;
}
std::uint32_t short_hash_of(std::span<const std::byte> bytes) {
  std::uint32_t hash = 0x811c9dc5u;
  for (const std::byte b : bytes) hash = (hash ^ std::to_integer<std::uint32_t>(b)) * 0x01000193u;
  return hash;
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// A sample as an integer whose order is that of the values. One to one, so that every bit comes back.
template <class T>
T ordered(T bits) {
  constexpr T sign = T(T(1) << (8 * sizeof(T) - 1));
  return static_cast<T>(bits & sign ? ~bits : bits | sign);
}
template <class T>
T from_ordered(T v) {
  constexpr T sign = T(T(1) << (8 * sizeof(T) - 1));
  return static_cast<T>(v & sign ? v ^ sign : ~v);
}

/// Small differences of either sign as small numbers.
template <class T>
T zigzag(T v) {
  return static_cast<T>(T(v << 1) ^ T(v >> (8 * sizeof(T) - 1) ? ~T(0) : T(0)));
}
template <class T>
T unzigzag(T v) {
  return static_cast<T>(T(v >> 1) ^ (v & 1 ? ~T(0) : T(0)));
}

/// Differences along the axis whose samples lie `stride` apart, in place; modulo 2^n, so nothing is lost.
template <class T>
void difference(std::vector<T>& v, std::size_t stride, std::size_t n) {
  const std::size_t plane = stride * n;
  for (std::size_t begin = 0; begin < v.size(); begin += plane)
    for (std::size_t i = begin + plane; i-- > begin + stride;) v[i] = static_cast<T>(v[i] - v[i - stride]);
}
template <class T>
void add_up(std::vector<T>& v, std::size_t stride, std::size_t n) {
  const std::size_t plane = stride * n;
  for (std::size_t begin = 0; begin < v.size(); begin += plane)
    for (std::size_t i = begin + stride; i < begin + plane; ++i) v[i] = static_cast<T>(v[i] + v[i - stride]);
}

struct Sides {
  std::size_t x, y, z;
  explicit Sides(Vec3i n) : x(n.x), y(n.y), z(n.z) {}
};

std::uint32_t to_bits(float v, std::uint32_t) {
  return std::bit_cast<std::uint32_t>(v);
}
std::uint16_t to_bits(float v, std::uint16_t) {
  return to_half(v);
}
float to_value(std::uint32_t bits) {
  return std::bit_cast<float>(bits);
}
float to_value(std::uint16_t bits) {
  return from_half(bits);
}

template <class T>
std::string encode(const std::vector<float>& values, Vec3i size) {
  std::vector<T> v(values.size());
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = ordered(to_bits(values[i], T()));
  const Sides n(size);
  difference(v, 1, n.x);
  difference(v, n.x, n.y);
  difference(v, n.x * n.y, n.z);
  std::string planes(v.size() * sizeof(T), '\0');
  for (std::size_t b = 0; b < sizeof(T); ++b)
    for (std::size_t i = 0; i < v.size(); ++i)
      planes[b * v.size() + i] = static_cast<char>(zigzag(v[i]) >> (8 * b) & 0xff);
  return planes;
}

template <class T>
void decode(const std::vector<std::byte>& planes, Vec3i size, std::vector<float>& values) {
  std::vector<T> v(values.size());
  for (std::size_t b = 0; b < sizeof(T); ++b)
    for (std::size_t i = 0; i < v.size(); ++i)
      v[i] = static_cast<T>(v[i] | std::to_integer<T>(planes[b * v.size() + i]) << (8 * b));
  for (T& d : v) d = unzigzag(d);
  const Sides n(size);
  add_up(v, n.x * n.y, n.z);
  add_up(v, n.x, n.y);
  add_up(v, 1, n.x);
  for (std::size_t i = 0; i < v.size(); ++i) values[i] = to_value(from_ordered(v[i]));
}

std::string compress(std::string_view raw) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, level);
  std::string out(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t n = ZSTD_compress2(context, out.data(), out.size(), raw.data(), raw.size());
  ZSTD_freeCCtx(context);
  if (ZSTD_isError(n)) fail(ErrorKind::internal, "zstd: {}", ZSTD_getErrorName(n));
  out.resize(n);
  return out;
}

/// Exactly out.size() bytes; false when they are not in `in`.
bool decompress(std::span<const std::byte> in, std::span<std::byte> out) {
  return ZSTD_decompress(out.data(), out.size(), in.data(), in.size()) == out.size();
}

std::string text_of(const MeshMetadata& metadata) {
  return impl::json_text({{"name", metadata.name},
                          {"crs", metadata.crs},
                          {"generator", impl::generator_json(metadata.generator)}});
}

std::string header_of(const Volume& volume, std::size_t text, std::size_t table) {
  const volume::GridFrame& frame = volume.grid.frame();
  std::string out(magic);
  impl::put(out, version);
  impl::put(out, std::uint32_t{volume.grid.precision() == Precision::half ? 2u : 4u});
  impl::put(out, volume.origin);
  impl::put(out, frame.origin);
  impl::put(out, frame.spacing);
  impl::put(out, frame.size);
  impl::put(out, std::uint32_t{ScalarGrid::chunk_samples});
  impl::put(out, std::uint64_t{text});
  impl::put(out, std::uint64_t{table});
  return out;
}

std::string encode_chunk(const ScalarGrid& grid, const volume::SampleBox& box) {
  const Vec3i n = box.size();
  std::vector<float> values(box.count());
  grid.read(box, values.data());
  return compress(grid.precision() == Precision::half ? encode<std::uint16_t>(values, n)
                                                      : encode<std::uint32_t>(values, n));
}

void write(AtomicFile& out, const Volume& volume, Progress& progress) {
  const ScalarGrid& grid = volume.grid;
  const impl::Chunks chunks(grid.frame());
  const std::int64_t total = chunks.count();
  std::vector<TableEntry> table(total);
  std::vector<std::string> data(table.size());
  parallel_for(
      total,
      [&](std::int64_t i) {
        TableEntry& entry = table[i];
        float same = 0;
        if (grid.uniform(chunks.place(i), &same)) {
          entry = {0, std::bit_cast<std::uint32_t>(same)};
          return;
        }
        std::string& chunk = data[i];
        chunk = encode_chunk(grid, chunks.box(i));
        entry = {static_cast<std::uint32_t>(chunk.size()), short_hash_of(bytes_of(chunk))};
      },
      progress);
  const std::string text = text_of(volume.metadata);
  const std::string packed =
      compress({reinterpret_cast<const char*>(table.data()), table.size() * sizeof(TableEntry)});
  std::string head = header_of(volume, text.size(), packed.size());
  impl::put(head, hash_of(bytes_of(packed), hash_of(bytes_of(text), hash_of(bytes_of(head)))));
  out.write(head);
  out.write(text);
  out.write(packed);
  for (const std::string& chunk : data) out.write(chunk);
}

/// A file's parts, checked.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, std::string_view file) : bytes_(bytes), file_(file) {
    if (bytes.size() < header_bytes || impl::as_text(bytes).substr(0, magic.size()) != magic)
      fail(ErrorKind::input,
           "{}: does not begin as a volume of tafoni does; it is of another format or cut off.", file);
    if (const auto v = impl::load<std::uint32_t>(bytes, 8); v != version)
      fail(ErrorKind::input,
           "{}: has version {} of the format, and this program reads {}; write it again with this program.",
           file, v, version);
    const auto text = impl::load<std::uint64_t>(bytes, 88), table = impl::load<std::uint64_t>(bytes, 96);
    const std::uint64_t left = bytes.size() - header_bytes;
    if (text > left || table > left - text) damaged("it is cut off");
    text_ = bytes.subspan(header_bytes, text);
    packed_table_ = bytes.subspan(header_bytes + text, table);
    data_ = bytes.subspan(header_bytes + text + table);
    if (hash_of(packed_table_, hash_of(text_, hash_of(bytes.first(hash_at)))) !=
        impl::load<std::uint64_t>(bytes, hash_at))
      damaged("its header does not match its checksum");
  }

  /// Reads all but the samples, into what load() needs.
  impl::VolumeSource open() {
    sample_ = impl::load<std::uint32_t>(bytes_, 12);
    if ((sample_ != 2 && sample_ != 4) || impl::load<std::uint32_t>(bytes_, 84) != ScalarGrid::chunk_samples)
      damaged("its header says what cannot be");
    impl::VolumeSource out{.frame = {impl::load<Vec3d>(bytes_, 40), impl::load<double>(bytes_, 64),
                                     impl::load<Vec3i>(bytes_, 72)},
                           .origin = impl::load<Vec3d>(bytes_, 16),
                           .precision = sample_ == 2 ? Precision::half : Precision::single,
                           .metadata = metadata()};
    impl::check_frame(out.frame, out.origin, file_);
    read_table(impl::Chunks(out.frame).count());
    out.full_chunks = find_repeats(impl::Chunks(out.frame));
    return out;
  }

  void load(std::int64_t index, Vec3i size, impl::ChunkValues& chunk) const {
    const TableEntry& entry = table_[index];
    if (entry.bytes == 0) {
      chunk.same = std::bit_cast<float>(entry.what);
      return;
    }
    const auto repeat = std::lower_bound(repeats_.begin(), repeats_.end(), std::pair{index, std::int64_t{0}});
    if (repeat != repeats_.end() && repeat->first == index) {
      chunk.like = repeat->second;
      return;
    }
    const auto packed = data_.subspan(starts_[index], entry.bytes);
    if (short_hash_of(packed) != entry.what) damaged("a chunk does not match its checksum");
    unpack(packed, size, chunk.values);
  }

 private:
  [[noreturn]] void damaged(std::string_view what) const {
    fail(ErrorKind::input, "{}: the file is damaged: {}; write it again.", file_, what);
  }

  MeshMetadata metadata() const {
    MeshMetadata out;
    const auto json = impl::read_json(impl::as_text(text_));
    if (!json.is_object()) damaged("its text cannot be read");
    const auto text = [&](const char* key) {
      return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
    };
    out.name = text("name");
    out.crs = text("crs");
    if (json.contains("generator")) out.generator = impl::generator_values(json["generator"]);
    return out;
  }

  /// The table's size is known before it is given memory, and bounded: zstd makes of a byte 20,000 at most.
  void read_table(std::int64_t chunks) {
    if (ZSTD_getFrameContentSize(packed_table_.data(), packed_table_.size()) != chunks * sizeof(TableEntry))
      damaged("its table of chunks is not that of its size");
    impl::check_memory(chunks, 0, Precision::single, bytes_.size(), file_);
    table_.resize(chunks);
    if (!decompress(packed_table_, std::as_writable_bytes(std::span(table_))))
      damaged("its table of chunks cannot be read");
    starts_.resize(table_.size() + 1);
    for (std::size_t i = 0; i < table_.size(); ++i) starts_[i + 1] = starts_[i] + table_[i].bytes;
    if (starts_.back() != data_.size()) damaged("it is cut off or something was appended");
  }

  /// Chunks whose bytes are those of an earlier one of the same size are read once. Gives how many others
  /// there are that hold more than one value.
  std::uint64_t find_repeats(const impl::Chunks& chunks) {
    std::uint64_t distinct = 0;
    std::map<std::tuple<std::uint32_t, std::uint32_t, int, int, int>, std::int64_t> first;
    for (std::int64_t i = 0; i < std::ssize(table_); ++i) {
      if (table_[i].bytes == 0) continue;
      const Vec3i size = chunks.box(i).size();
      const auto [found, fresh] =
          first.try_emplace({table_[i].bytes, table_[i].what, size.x, size.y, size.z}, i);
      const auto own = data_.subspan(starts_[i], table_[i].bytes);
      if (!fresh && std::equal(own.begin(), own.end(), data_.begin() + starts_[found->second]))
        repeats_.emplace_back(i, found->second);
      else
        ++distinct;
    }
    return distinct;
  }

  void unpack(std::span<const std::byte> packed, Vec3i size, std::vector<float>& values) const {
    std::vector<std::byte> planes(values.size() * sample_);
    if (!decompress(packed, planes)) damaged("a chunk cannot be read");
    if (sample_ == 2)
      decode<std::uint16_t>(planes, size, values);
    else
      decode<std::uint32_t>(planes, size, values);
  }

  std::span<const std::byte> bytes_, text_, packed_table_, data_;
  std::string file_;
  std::uint32_t sample_ = 0;  ///< bytes of one
  std::vector<TableEntry> table_;
  std::vector<std::uint64_t> starts_;
  std::vector<std::pair<std::int64_t, std::int64_t>>
      repeats_;  ///< chunks that are like an earlier one, and which
};

impl::VolumeSource open(std::span<const std::byte> bytes, std::string_view file) {
  const auto reader = std::make_shared<Reader>(bytes, file);
  impl::VolumeSource out = reader->open();
  out.load = [reader](std::int64_t index, const volume::SampleBox& box, impl::ChunkValues& chunk) {
    reader->load(index, box.size(), chunk);
  };
  return out;
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "tvol",
                .doc = "Volumes of tafoni: every bit, in chunks, compressed, with checksums",
                .source = "the layout stands at the head of io/formats/tvol.cpp"},
      .extensions = {"tvol"},
      .write_volume = write,
      .open_volume = open,
  };
  return type;
}

}  // namespace tafoni::io::format_tvol
