#pragma once
// Makes the mesh of one chunk of a scalar grid, and makes it anew where samples changed.
//
// A chunk's samples are taken as a block that reaches one sample beyond its voxels, for the gradients.

#include <array>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "tafoni/mesh/grid_mesher.h"
#include "tafoni/mesh/impl/block.h"

namespace tafoni::mesh::impl {

/// Which voxels a chunk has, and where its block lies.
class GridLayout {
 public:
  GridLayout(const volume::GridFrame& frame, Boundary boundary);

  struct Block {
    Vec3i origin;   ///< sample (0, 0, 0) of the block
    Vec3i samples;  ///< a side, at most 37
    Vec3i lo, hi;   ///< voxels of the block that are the chunk's, hi exclusive
  };
  Block block(Vec3i chunk) const;
  Vec3i chunks() const { return chunks_; }  ///< a side
  /// The chunks whose mesh depends on these samples: first and last, last before first for none.
  std::pair<Vec3i, Vec3i> touched(const volume::SampleBox& samples) const;
  /// The chunk that an edge of the lattice is counted to, by the sample it starts from.
  Vec3i owner(Vec3i sample) const;

  const volume::GridFrame frame;
  const Boundary boundary;
  const float margin;

 private:
  Vec3i chunks_;
};

/// What is held of a chunk with surface.
struct GridChunkState {
  GridChunkPtr mesh;
  std::vector<std::uint32_t> edges;   ///< of the block, by vertex, ascending: see edge_place()
  std::vector<std::uint64_t> solid;   ///< bits of the block's samples, a word a row
  std::vector<std::uint64_t> cut;     ///< bits of the voxels that the surface cuts, a word a row
  std::vector<std::uint8_t> any_cut;  ///< by layer of voxels
  std::vector<std::uint8_t> merges;   ///< of each cut voxel: see ConvexCase
};

/// Orders edges as their vertices are: by plane, row, axis and column.
constexpr std::uint32_t edge_place(int i, int j, int k, int axis) {
  return static_cast<std::uint32_t>((((k << 6 | j) << 2) | axis) << 6 | i);
}
constexpr Vec3i place_start(std::uint32_t place) {
  return {static_cast<int>(place & 63), static_cast<int>((place >> 8) & 63), static_cast<int>(place >> 14)};
}

constexpr int place_axis(std::uint32_t place) {
  return static_cast<int>((place >> 6) & 3);
}

inline bool voxel_before(Vec3i a, Vec3i b) {
  return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
}

/// One a thread; its memory is used again from chunk to chunk.
class GridChunkMaker {
 public:
  GridChunkMaker(const GridLayout& layout, bool polygons);

  /// Brings the state up to date, whose samples outside of `changed` (the grid's) are as they were; an empty
  /// state is made whole. Whether the mesh changed; it is null then where no surface is left.
  bool make(const volume::ScalarGrid& grid, Vec3i chunk, const volume::SampleBox& changed,
            std::uint64_t version, GridChunkState& state);

  /// For BlockWalker.
  bool layer(int k) const {
    return k >= 0 && k < block_.samples.z - 1 && state_->any_cut[static_cast<std::size_t>(k)];
  }
  const std::uint64_t* rows(int k) const { return state_->cut.data() + k * (block_.samples.y - 1); }
  void vertices(int k, const PlaneOutput& out);
  void triangles(const PlaneOutput& out);

 private:
  /// Rows of a plane, or planes, both included.
  struct Rows {
    int first, last;
    bool has(int at) const { return at >= first && at <= last; }
  };

  void read(const volume::ScalarGrid& grid, const volume::SampleBox& part);
  void add_air(const volume::SampleBox& part);
  void update_bits();
  void keep(std::uint32_t from, std::uint32_t to);
  void place_fresh(int k, const EdgeKey* keys, std::size_t n);
  void point_walls_outward(int k, const EdgeKey* keys, std::size_t n, float* normals) const;
  void join_polygons(VoxelPolygons& out);
  std::size_t old_voxel(Vec3i voxel) const;
  bool finish(std::uint64_t version);

  const GridLayout& layout_;
  const bool polygons_;
  GridLayout::Block block_;
  GridChunkState* state_ = nullptr;
  Rows changed_rows_{}, changed_planes_{}, fresh_rows_{}, fresh_planes_{};

  std::vector<float> memory_;  ///< the block, with slack on both ends
  float* samples_ = nullptr;
  Plane plane_;
  BlockWalker walker_;
  Buffer<float> positions_, normals_;
  Buffer<std::uint32_t> edges_, indices_;
};

}  // namespace tafoni::mesh::impl
