#pragma once
// Sampled fields ([Ju01], [Ruths01]): a dense lattice of values in chunks, sparse where uniform.
// Solid where a value is > 0, open where < 0, as [Ju01] has it.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/function.h"
#include "tafoni/math/vec.h"

namespace tafoni::volume {

/// Sample (i, j, k), 0 <= i < size.x and so on, lies at origin + spacing * (i, j, k), local metres.
struct GridFrame {
  Vec3d origin;
  double spacing = 1;
  Vec3i size{2, 2, 2};  ///< samples a side, at least 2

  Vec3d position(Vec3i s) const { return origin + Vec3d{spacing * s.x, spacing * s.y, spacing * s.z}; }
  Box3d box() const { return {origin, position({size.x - 1, size.y - 1, size.z - 1})}; }
  friend bool operator==(const GridFrame&, const GridFrame&) = default;
};

/// Throws Error{usage} for a frame that no grid has: without cells, of more than 2^40 samples, of more than
/// 2^30 a side, or not finite.
void check(const GridFrame& frame);

/// Samples from lo to hi, both included; empty where a side of hi is below lo's.
struct SampleBox {
  Vec3i lo{0, 0, 0}, hi{-1, -1, -1};

  bool empty() const { return hi.x < lo.x || hi.y < lo.y || hi.z < lo.z; }
  Vec3i size() const { return {hi.x - lo.x + 1, hi.y - lo.y + 1, hi.z - lo.z + 1}; }
  /// How many samples, of a box that is not empty.
  std::int64_t count() const { return std::int64_t{size().x} * size().y * size().z; }
  /// The place of a sample among those of the box, x fastest, z slowest.
  std::int64_t index(Vec3i s) const {
    return (std::int64_t{s.z - lo.z} * size().y + (s.y - lo.y)) * size().x + (s.x - lo.x);
  }
  friend bool operator==(const SampleBox&, const SampleBox&) = default;
};

enum class Precision { single, half };

/// Copies share chunks until one of them is edited: a copy is a snapshot that other threads may read while
/// the original is edited. Editing one object is for one thread at a time.
class ScalarGrid {
 public:
  /// Chunk (a, b, c) holds the samples from (32 a, 32 b, 32 c): 128 KB, half of it in half precision; one
  /// value where all are the same.
  static constexpr int chunk_samples = 32;

  /// Throws Error{usage} as check() does.
  ScalarGrid(const GridFrame& frame, float value, Precision precision = Precision::single);
  ScalarGrid(const ScalarGrid&);
  ScalarGrid& operator=(const ScalarGrid&);
  ScalarGrid(ScalarGrid&&) noexcept;
  ScalarGrid& operator=(ScalarGrid&&) noexcept;
  ~ScalarGrid();

  const GridFrame& frame() const;
  Precision precision() const;
  SampleBox samples() const;  ///< all of them
  Vec3i chunks() const;       ///< a side
  /// The samples within `box`, local metres, of the cells that it touches too.
  SampleBox samples_in(const Box3d& box) const;

  /// Indices beyond the frame take the nearest sample's value, here and in read().
  float at(Vec3i sample) const;
  /// out[(z * ny + y) * nx + x], counted from box.lo.
  void read(const SampleBox& box, float* out) const;
  /// Within the frame, `in` as read() has it, of finite values. Half precision rounds to the nearest half (at
  /// most 65504 either way). Works on several threads where the box is large.
  void write(const SampleBox& box, const float* in);
  /// Gives every sample of the box, within the frame, the value. Chunks wholly in it then take no memory.
  void fill(const SampleBox& box, float value);
  /// Gives one chunk all that another of as many samples holds. They share the memory until one is edited.
  void share(Vec3i from, Vec3i to);
  /// `change(first, row)` may alter the values of a run of samples along x. A run never crosses a chunk;
  /// chunks are visited in order and by one thread. Other threads may edit other chunks meanwhile. Gives the
  /// box of the samples whose value changed.
  SampleBox edit(const SampleBox& box, const std::function<void(Vec3i first, std::span<float> row)>& change);
  /// Makes every chunk anew, on several threads: make(samples, out) gives the value that all of the chunk's
  /// `samples` have, or none after it wrote them, finite, to out[(z * 32 + y) * 32 + x], counted from
  /// samples.lo.
  void generate(const std::function<std::optional<float>(const SampleBox& samples, float* out)>& make,
                Progress& progress = silent());
  /// Chunks whose samples became all alike give their memory back.
  void compact();

  /// Trilinear; beyond the frame the nearest point's value. The same bits at any call.
  float value(Vec3d p) const;
  void values(std::span<const Vec3d> points, std::span<float> out) const;
  /// Of the trilinear function inside the cell; one side's at a cell's face.
  void gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const;
  /// Encloses value() over the box; within twice a brick of 8^3 cells it is tight.
  Interval range(const Box3d& box) const;

  /// The chunk's 32^3 values, x fastest, when it is held in full and in single precision; else null, and
  /// uniform() or read() tell. Valid until the grid is edited.
  const float* chunk(Vec3i chunk) const;
  bool uniform(Vec3i chunk, float* value = nullptr) const;
  std::uint64_t full_chunks() const;
  std::uint64_t bytes() const;  ///< of memory, shared chunks included
  /// What a grid takes besides its full chunks for each chunk, and a full chunk.
  static std::uint64_t slot_bytes();
  static std::uint64_t full_chunk_bytes(Precision precision);

  /// Frames, precision and every sample's bits.
  friend bool operator==(const ScalarGrid& a, const ScalarGrid& b);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A leaf for construction trees: the grid's trilinear values as they are now.
field::FunctionPtr as_function(const ScalarGrid& grid);

}  // namespace tafoni::volume
