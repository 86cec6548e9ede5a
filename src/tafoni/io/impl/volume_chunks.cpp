// What formats of volumes share: chunks in their order, filled by many threads in groups and checked to
// be finite, and the generator's values as JSON.

#include "tafoni/io/impl/volume_chunks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"

namespace tafoni::io::impl {

using volume::SampleBox;
using volume::ScalarGrid;

namespace {

/// To the bit, so that zeros of both signs differ.
bool all_alike(const std::vector<float>& values) {
  return std::memcmp(values.data(), values.data() + 1, (values.size() - 1) * sizeof(float)) == 0;
}

}  // namespace

std::int64_t chunk_count(const ScalarGrid& grid) {
  const Vec3i n = grid.chunks();
  return std::int64_t{n.x} * n.y * n.z;
}

Vec3i chunk_place(const ScalarGrid& grid, std::int64_t index) {
  const Vec3i n = grid.chunks();
  return {static_cast<int>(index % n.x), static_cast<int>(index / n.x % n.y),
          static_cast<int>(index / n.x / n.y)};
}

SampleBox chunk_box(const ScalarGrid& grid, std::int64_t index) {
  constexpr int side = ScalarGrid::chunk_samples;
  const Vec3i lo = chunk_place(grid, index) * side, size = grid.frame().size;
  return {lo,
          {std::min(lo.x + side, size.x) - 1, std::min(lo.y + side, size.y) - 1,
           std::min(lo.z + side, size.z) - 1}};
}

Volume empty_volume(const volume::GridFrame& frame, float value, volume::Precision precision, Vec3d origin,
                    std::string_view file) {
  if (!Box3d{origin, origin}.bounded())
    fail(ErrorKind::input, "{}: the place of its volume is not finite; the file is damaged.", file);
  try {
    return {ScalarGrid(frame, value, precision), origin, {}};
  } catch (const Error& error) {
    fail(ErrorKind::input, "{}: {}", file, error.what());
  }
}

void fill_chunks(ScalarGrid& grid, std::string_view file,
                 const std::function<void(std::int64_t index, ChunkValues& chunk)>& load,
                 Progress& progress) {
  const std::int64_t total = chunk_count(grid);
  constexpr std::int64_t group = 128;
  std::vector<ChunkValues> chunks(std::min(total, group));
  for (std::int64_t begin = 0; begin < total; begin += group) {
    const std::int64_t count = std::min(group, total - begin);
    parallel_for(
        count,
        [&](std::int64_t i) {
          ChunkValues& chunk = chunks[i];
          chunk.same.reset();
          chunk.values.resize(chunk_box(grid, begin + i).count());
          load(begin + i, chunk);
          if (!chunk.same && all_alike(chunk.values)) chunk.same = chunk.values.front();
          const bool finite = chunk.same ? std::isfinite(*chunk.same)
                                         : std::all_of(chunk.values.begin(), chunk.values.end(),
                                                       [](float v) { return std::isfinite(v); });
          if (!finite)
            fail(ErrorKind::input, "{}: holds values that are not finite; the file is damaged.", file);
        },
        progress);
    for (std::int64_t i = 0; i < count; ++i) {
      const ChunkValues& chunk = chunks[i];
      if (chunk.same)
        grid.fill(chunk_box(grid, begin + i), *chunk.same);
      else
        grid.write(chunk_box(grid, begin + i), chunk.values.data());
    }
  }
}

std::string generator_json(const Values& values) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, value] : values)
    std::visit([&, &key = name](const auto& v) { json[key] = v; }, value);
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Values generator_values(std::string_view text) {
  return generator_values_of(nlohmann::json::parse(text, nullptr, false));
}

Values generator_values_of(const nlohmann::json& json) {
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

}  // namespace tafoni::io::impl
