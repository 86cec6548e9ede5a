#pragma once
// A field on a lattice, chunk by chunk: the samples that polygonization needs and no others.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/math/vec.h"

namespace tafoni::field {

class CompiledField;

/// The lattice: sample (i, j, k) lies at local (i, j, k) * voxel. Chunks of 64^3 cells tile it; chunk (a, b,
/// c) holds the cells from (64 a, 64 b, 64 c).
inline constexpr int chunk_cells = 64;
inline constexpr int brick_cells = 8;
inline constexpr int chunk_bricks = chunk_cells / brick_cells;

/// A box of bricks of one chunk, both ends included; by default all of them.
struct BrickBox {
  Vec3i lo{0, 0, 0}, hi{chunk_bricks - 1, chunk_bricks - 1, chunk_bricks - 1};
};

/// The samples of one chunk's cells, valid wherever an active brick of 8^3 cells needs them. Neighbours'
/// samples on a shared face are equal bit for bit.
struct ChunkSamples {
  static constexpr int nx = 72, ny = 65, nz = 65;  ///< x is padded; 65 samples a side are used

  float at(int i, int j, int k) const { return f[sample_index({nx, ny, nz}, {i, j, k})]; }
  bool brick(int bx, int by, int bz) const { return (active[bz] >> (by * 8 + bx)) & 1u; }
  /// How many samples along each axis, from sample (8 bx, 8 by, 8 bz), the active bricks of `among` read of
  /// those 8^3: all of a brick's own and the near faces of the next ones'. All 0 where none reads any.
  Vec3i read(int bx, int by, int bz, const BrickBox& among) const;

  Vec3i chunk;
  std::vector<float> f;                     ///< [nz][ny][nx]
  std::uint64_t active[chunk_bricks] = {};  ///< bit by*8+bx of entry bz: the brick may hold the surface
  std::uint64_t evaluated = 0;              ///< samples computed, for statistics
  bool any() const {
    for (auto a : active)
      if (a) return true;
    return false;
  }
};

/// Evaluates chunks of one field on one lattice. One a thread; reuses its memory between chunks.
class ChunkEvaluator {
 public:
  /// On the lattice whose sample (0, 0, 0) lies at `origin`: sample (i, j, k) at origin + voxel * (i, j, k).
  /// A brick is active where values from -band to band are possible.
  ChunkEvaluator(const CompiledField& field, double voxel, Vec3d origin = {}, float band = 0);
  ~ChunkEvaluator();
  ChunkEvaluator(const ChunkEvaluator&) = delete;
  ChunkEvaluator& operator=(const ChunkEvaluator&) = delete;
  /// What is under way ends when `progress`, which must live as long, is cancelled: a chunk may take seconds.
  void watch(const Progress& progress);

  /// The chunk indices along z, first to last (inclusive), in which column (a, b) may hold surface;
  /// first > last when none. Cheap; prepares the column for evaluate().
  struct Range {
    int first = 0, last = -1;
  };
  Range column(int a, int b);
  /// Samples of chunk (a, b, c) of the column last prepared. False when no brick is active.
  /// The 9^3 samples of an inactive brick's closure lie all above the band or all below it.
  bool evaluate(int c, ChunkSamples& out);
  /// The same of the bricks in `box` alone, for a field that changed within them: out.active keeps the flags
  /// of the other bricks, and of the samples only those that active bricks of the box read are written. False
  /// when no brick of the box is active. gradients() then takes points of the box alone.
  bool evaluate(int c, const BrickBox& box, ChunkSamples& out);
  /// Gradients at local points within the chunk last evaluated (its closed box); bit-identical to
  /// CompiledField::gradients.
  void gradients(std::span<const Vec3d> points, std::span<float> values, std::span<Vec3f> gradients);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::field
