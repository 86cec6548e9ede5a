// What formats of volumes share: chunks in their order, read by many threads in groups and checked to be
// finite, and the generator's values as JSON. A small file could name more samples than any memory holds, so
// what they need is reckoned first and compared with what a file of that size can mean.

#include "tafoni/io/impl/volume_chunks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/io/impl/json_text.h"

namespace tafoni::io::impl {

using volume::SampleBox;
using volume::ScalarGrid;

namespace {

/// Memory that any file may take for chunks of one value and for others, and what it may take for each of its
/// bytes. Of real volumes a chunk's 128 KB take some kilobytes, of the plainest ones (a tilted plane) 200.
constexpr std::uint64_t granted_uniform = 96 << 20, granted_full = 256 << 20, granted_a_byte = 1000;
/// Of a file's own table, for each chunk, while it is read.
constexpr std::uint64_t table_bytes = 16;
constexpr std::int64_t chunks_at_once = 128;

/// To the bit, so that zeros of both signs differ.
bool all_alike(const std::vector<float>& values) {
  return std::memcmp(values.data(), values.data() + 1, (values.size() - 1) * sizeof(float)) == 0;
}

/// Reads all chunks, in groups: take(index, box, chunk) sees one after the other.
template <class Take>
void visit_chunks(const VolumeSource& source, std::string_view file, const Take& take, Progress& progress) {
  const Chunks all(source.frame);
  const std::int64_t total = all.count();
  progress.begin("reading " + std::string(file), total, "chunks");
  std::vector<ChunkValues> group(std::min(total, chunks_at_once));
  for (std::int64_t begin = 0; begin < total; begin += chunks_at_once) {
    const std::int64_t count = std::min(chunks_at_once, total - begin);
    parallel_for(
        count,
        [&](std::int64_t i) {
          ChunkValues& chunk = group[i];
          const SampleBox box = all.box(begin + i);
          chunk.same.reset();
          chunk.like.reset();
          chunk.values.resize(box.count());
          source.load(begin + i, box, chunk);
          if (chunk.like) return;
          if (!chunk.same && all_alike(chunk.values)) chunk.same = chunk.values.front();
          const bool finite = chunk.same ? std::isfinite(*chunk.same)
                                         : std::all_of(chunk.values.begin(), chunk.values.end(),
                                                       [](float v) { return std::isfinite(v); });
          if (!finite)
            fail(ErrorKind::input, "{}: holds values that are not finite; the file is damaged.", file);
        },
        progress);
    for (std::int64_t i = 0; i < count; ++i) take(begin + i, all.box(begin + i), group[i]);
  }
  progress.end();
}

std::uint64_t memory_of(std::int64_t chunks, std::uint64_t full_chunks, volume::Precision precision) {
  return chunks * ScalarGrid::slot_bytes() + full_chunks * ScalarGrid::full_chunk_bytes(precision);
}

}  // namespace

Chunks::Chunks(const volume::GridFrame& frame) : size_(frame.size) {
  const auto count = [](int samples) { return (samples - 1) / ScalarGrid::chunk_samples + 1; };
  n_ = {count(size_.x), count(size_.y), count(size_.z)};
}

Vec3i Chunks::place(std::int64_t index) const {
  return {static_cast<int>(index % n_.x), static_cast<int>(index / n_.x % n_.y),
          static_cast<int>(index / n_.x / n_.y)};
}

SampleBox Chunks::box(std::int64_t index) const {
  constexpr int side = ScalarGrid::chunk_samples;
  const Vec3i lo = place(index) * side;
  return {lo,
          {std::min(lo.x + side, size_.x) - 1, std::min(lo.y + side, size_.y) - 1,
           std::min(lo.z + side, size_.z) - 1}};
}

void check_frame(const volume::GridFrame& frame, Vec3d origin, std::string_view file) {
  if (!Box3d{origin, origin}.bounded())
    fail(ErrorKind::input, "{}: the place of its volume is not finite; the file is damaged.", file);
  try {
    volume::check(frame);
  } catch (const Error& error) {
    fail(ErrorKind::input, "{}: {}", file, error.what());
  }
}

void check_memory(std::int64_t chunks, std::uint64_t full_chunks, volume::Precision precision,
                  std::uint64_t file_bytes, std::string_view file) {
  const std::uint64_t uniform = chunks * (ScalarGrid::slot_bytes() + table_bytes),
                      full = full_chunks * ScalarGrid::full_chunk_bytes(precision);
  if (uniform > granted_uniform + granted_a_byte * file_bytes ||
      full > granted_full + granted_a_byte * file_bytes)
    fail(ErrorKind::input,
         "{}: would take {:.2g} GB of memory, which no volume of {:.2g} MB needs; it is damaged, or made to "
         "fill the memory.",
         file, static_cast<double>(uniform + full) / 1e9, static_cast<double>(file_bytes) / 1e6);
}

Volume read_samples(const VolumeSource& source, std::string_view file, std::uint64_t file_bytes,
                    Progress& progress) {
  check_memory(Chunks(source.frame).count(), source.full_chunks, source.precision, file_bytes, file);
  Volume out{ScalarGrid(source.frame, 0, source.precision), source.origin, source.metadata};
  const Chunks all(source.frame);
  visit_chunks(
      source, file,
      [&](std::int64_t index, const SampleBox& box, const ChunkValues& chunk) {
        if (chunk.like)
          out.grid.share(all.place(*chunk.like), all.place(index));
        else if (chunk.same)
          out.grid.fill(box, *chunk.same);
        else
          out.grid.write(box, chunk.values.data());
      },
      progress);
  return out;
}

VolumeInfo look_at_samples(const VolumeSource& source, std::string_view file, std::uint64_t file_bytes,
                           Progress& progress) {
  check_memory(Chunks(source.frame).count(), source.full_chunks, source.precision, file_bytes, file);
  VolumeInfo out{.frame = source.frame,
                 .origin = source.origin,
                 .precision = source.precision,
                 .metadata = source.metadata,
                 .chunks = Chunks(source.frame).count()};
  bool first = true;
  visit_chunks(
      source, file,
      [&](std::int64_t, const SampleBox&, const ChunkValues& chunk) {
        if (chunk.like) {
          ++out.full_chunks;
          return;
        }
        const float one[] = {chunk.same.value_or(0)};
        const std::span<const float> values =
            chunk.same ? std::span<const float>(one) : std::span<const float>(chunk.values);
        const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
        out.values =
            first ? Interval{*lo, *hi} : Interval{std::min(out.values.lo, *lo), std::max(out.values.hi, *hi)};
        first = false;
        if (!chunk.same) ++out.full_chunks, ++out.distinct_chunks;
      },
      progress);
  out.bytes = memory_of(out.chunks, out.distinct_chunks, out.precision);
  return out;
}

nlohmann::json generator_json(const Values& values) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, value] : values)
    std::visit([&, &key = name](const auto& v) { json[key] = v; }, value);
  return json;
}

Values generator_values(const nlohmann::json& json) {
  Values values;
  if (!json.is_object()) return values;
  for (const auto& [name, value] : json.items()) {
    if (value.is_boolean())
      values[name] = value.get<bool>();
    else if (value.is_number_integer())
      values[name] = value.get<std::int64_t>();
    else if (value.is_number())
      values[name] = value.get<double>();
    else if (value.is_string())
      values[name] = value.get<std::string>();
  }
  return values;
}

std::string generator_text(const Values& values) {
  return json_text(generator_json(values));
}

Values generator_from_text(std::string_view text) {
  return generator_values(read_json(text));
}

}  // namespace tafoni::io::impl
