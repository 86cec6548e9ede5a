#pragma once
// What formats of volumes share: chunks in their order, what a file's volume is before its samples are read,
// and the reading of these, in groups whose slow part runs in parallel.

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

/// The samples of one chunk: all alike, or those of an earlier chunk of the same size, or one by one, x
/// fastest.
struct ChunkValues {
  std::optional<float> same;
  std::optional<std::int64_t> like;
  std::vector<float> values;
};

/// The chunks of a grid of samples, x fastest.
class Chunks {
 public:
  /// Of a frame that check() lets pass.
  explicit Chunks(const volume::GridFrame& frame);

  std::int64_t count() const { return std::int64_t{n_.x} * n_.y * n_.z; }
  Vec3i place(std::int64_t index) const;
  /// The samples of it that lie in the frame.
  volume::SampleBox box(std::int64_t index) const;

 private:
  Vec3i size_, n_;
};

/// A volume's file, opened: all that it says besides its samples, which are still to be read.
struct VolumeSource {
  volume::GridFrame frame;
  Vec3d origin;
  volume::Precision precision = volume::Precision::single;
  MeshMetadata metadata = {};
  std::uint64_t full_chunks = 0;  ///< that hold more than one value and are like no earlier one, at most
  /// Reads a chunk, whose values have their size; called for many at once. Keeps the file's bytes.
  std::function<void(std::int64_t index, const volume::SampleBox& box, ChunkValues& chunk)> load = {};
};

/// Throws Error{input} naming `file` for a frame that no grid has and for a place that is not finite; called
/// before a frame's size is relied on.
void check_frame(const volume::GridFrame& frame, Vec3d origin, std::string_view file);

/// Throws Error{input} naming `file` where so many chunks, so many of them full, would take more memory than
/// a file of so many bytes can mean.
void check_memory(std::int64_t chunks, std::uint64_t full_chunks, volume::Precision precision,
                  std::uint64_t file_bytes, std::string_view file);

/// Reads what was opened from a file of so many bytes. Throws Error{input} naming `file` for a value that is
/// not finite and for more samples than such a file can hold in earnest. One progress step a chunk.
Volume read_samples(const VolumeSource& source, std::string_view file, std::uint64_t file_bytes,
                    Progress& progress);
/// The same without keeping them.
VolumeInfo look_at_samples(const VolumeSource& source, std::string_view file, std::uint64_t file_bytes,
                           Progress& progress);

/// The generator's values as JSON, and back; what cannot be read is left out.
nlohmann::json generator_json(const Values& values);
Values generator_values(const nlohmann::json& json);
/// The same as text.
std::string generator_text(const Values& values);
Values generator_from_text(std::string_view text);

}  // namespace tafoni::io::impl
