#pragma once
// One program over one chunk of the lattice: what a column and a chunk share, ranges and samples of bricks.

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "tafoni/field/chunks.h"
#include "tafoni/field/impl/points.h"
#include "tafoni/field/impl/program.h"

namespace tafoni::field::impl {

inline constexpr int sides = chunk_bricks + 1;  ///< sample bricks a side: the last holds only the far face

inline int brick_index(int bx, int by, int bz) {
  return (bz * sides + by) * sides + bx;
}

/// Where a chunk's samples lie.
struct ChunkFrame {
  double voxel;
  Vec3d origin;  ///< of sample (0, 0, 0) of chunk (0, 0, 0)
  float band;    ///< values beyond +-band need not be told from one another
  Vec3i chunk;
  Axis x, y, z;

  bool beyond(Interval r) const { return r.lo > band || r.hi < -band; }
  /// Sample i of an axis in float metres, rounded outward by what float can lose.
  static float low(const Axis& axis, int i) { return static_cast<float>(axis.metres[i]) - position_slack; }
  static float high(const Axis& axis, int i) { return static_cast<float>(axis.metres[i]) + position_slack; }
  Box3f brick_box(int bx, int by, int bz) const;
  /// The closure of `side` bricks a side from (bx, by, bz) on.
  Box3d closure(int bx, int by, int bz, int side) const;
};

/// Least and greatest of a column array over the closure of each 8 x 8 cell brick.
struct BrickRange {
  float lo[chunk_bricks * chunk_bricks], hi[chunk_bricks * chunk_bricks];
};

class ChunkWork {
 public:
  ChunkWork(const Program& program, const ChunkFrame& frame);

  /// Prepares the frame's column. Elevations outside of which height leaves, domains and clouds are constant,
  /// and nested leaves mostly; lo > hi when there are none.
  Interval set_column();
  /// Prepares the frame's chunk, for the bricks of `box` and what they read. How many primitives touch those.
  std::size_t set_chunk(const BrickBox& box);
  /// The column's range over the elevations [lo, hi] where no primitive touches that.
  Interval bare_range(double lo, double hi);
  bool may_hold_surface(int bx, int by, int bz);
  /// The first (nx, ny, nz) samples from sample (8 bx, 8 by, 8 bz) on; rows of `target` have room for eight.
  void evaluate(int bx, int by, int bz, int nx, const Block& target);

  const Program& program() const { return program_; }
  PointWork& points() { return points_; }
  /// What the primitives of each cloud are that may touch brick `b`'s closure.
  void lists(std::size_t b, std::vector<PointWork::List>& out) const;

 private:
  struct Height {
    Columns columns;
    BrickRange value, scale;
    Interval all_value, all_scale;
  };
  struct Plane {
    Columns columns;
    BrickRange value;
    Interval all_value;
  };
  /// Primitives of one cloud that may touch the chunk column, and who touches which brick's closure.
  struct CloudPart {
    Primitives column;
    std::vector<std::uint32_t> begin;  ///< sides^3 + 1
    std::vector<std::uint32_t> items;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  };
  /// Of a nested leaf: its ranges over the chunk's eight octants, asked at need, which spare most bricks a
  /// question; and its program, for bricks where the leaf leaves that as it is.
  struct NestedPart {
    Interval range[8];
    unsigned known = 0;
    std::unique_ptr<ChunkWork> still;
    bool column_set = false, chunk_set = false;
  };

  std::size_t list_primitives(CloudPart& part, const BrickBox& box);
  /// Over the closure of cell brick (bx, by, bz). `coarse`: with the nested leaves' ranges over its octant.
  Interval brick_range(int bx, int by, int bz, bool coarse);
  Interval nested_range(std::size_t index, int bx, int by, int bz, bool coarse);
  Interval octant_range(std::size_t index, int bx, int by, int bz);
  /// The nested leaf's program, prepared for the chunk, where it has the leaf's values over the box; or null.
  ChunkWork* still(std::size_t index, const Box3d& box);
  void nested_block(std::size_t index, int bx, int by, int bz, int nx, const Block& block);

  const Program& program_;
  const ChunkFrame& frame_;
  const LeafKernels& kernels_ = leaf_kernels();
  BrickBox box_;
  std::vector<Height> heights_;
  std::vector<Plane> domains_;
  std::vector<CloudPart> clouds_;
  std::vector<NestedPart> nested_;
  RangeWork ranges_;
  std::vector<std::uint32_t> cursor_;
  std::vector<std::vector<float>> scratch_;  ///< one block a stack slot above the first
  PointWork points_;
  std::vector<Vec3d> lattice_points_;
  std::vector<float> lattice_values_;
};

}  // namespace tafoni::field::impl
