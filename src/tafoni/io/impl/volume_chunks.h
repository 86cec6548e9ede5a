#pragma once
// What formats of volumes share: a grid's chunks in order, in groups whose slow part runs in parallel.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tafoni/core/progress.h"
#include "tafoni/io/volume_file.h"

namespace tafoni::io::impl {

/// The samples of one chunk: all alike, or one by one, x fastest.
struct ChunkValues {
  std::optional<float> same;
  std::vector<float> values;
};

std::int64_t chunk_count(const volume::ScalarGrid& grid);
/// Chunk `index`, x fastest, as its place and as the samples of it that lie in the frame.
Vec3i chunk_place(const volume::ScalarGrid& grid, std::int64_t index);
volume::SampleBox chunk_box(const volume::ScalarGrid& grid, std::int64_t index);

/// A volume of one value, before its samples are read. Throws Error{input} naming `file` for a frame that no
/// grid has and a place that is not finite.
Volume empty_volume(const volume::GridFrame& frame, float value, volume::Precision precision, Vec3d origin,
                    std::string_view file);

/// Fills the grid with what load(index, chunk) gives; load runs on many threads at once. Throws Error{input}
/// naming `file` for a value that is not finite. One progress step a chunk.
void fill_chunks(volume::ScalarGrid& grid, std::string_view file,
                 const std::function<void(std::int64_t index, ChunkValues& chunk)>& load, Progress& progress);

/// The generator's values as JSON, and back; what cannot be read is left out.
std::string generator_json(const Values& values);
Values generator_values(std::string_view json);
Values generator_values_of(const nlohmann::json& json);

}  // namespace tafoni::io::impl
