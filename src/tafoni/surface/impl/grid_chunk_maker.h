#pragma once
// Makes the mesh of one chunk of a scalar grid, and makes it anew where samples changed: rows of the lattice
// that a change does not reach keep their vertices, triangles and polygons, moved to their new places.

#include <cstdint>
#include <vector>

#include "tafoni/surface/grid_mesher.h"
#include "tafoni/surface/impl/buffer.h"
#include "tafoni/surface/impl/grid_layout.h"
#include "tafoni/surface/impl/kernels.h"

namespace tafoni::surface::impl {

/// Which edges that start in a row of a block's samples carry a vertex, as bits by column. Vertices are
/// ordered by plane, row, axis and column.
struct RowEdges {
  std::uint64_t x, y, z;
};

/// What is held of a chunk with surface. Rows of samples are numbered k * samples.y + j, rows of voxels
/// k * (samples.y - 1) + j.
struct GridChunkState {
  GridChunkPtr mesh;
  std::vector<std::uint64_t> solid;        ///< bits of each row of samples
  std::vector<std::uint32_t> vertex_at;    ///< first of each row, and their number
  std::vector<std::uint32_t> triangle_at;  ///< first of each row of voxels, and their number
  std::vector<std::uint32_t> voxel_at;     ///< first cut voxel of each row, and their number; with polygons

  RowEdges edges(const GridLayout::Block& block, int j, int k) const;
};

/// Each thread has its own maker, whose memory is used again from chunk to chunk.
class GridChunkMaker {
 public:
  GridChunkMaker(const GridLayout& layout, bool polygons);

  /// Brings the state up to date, whose samples outside of `changed` (the grid's) are as they were; an empty
  /// state is made whole. Whether the mesh changed; it is null then where no surface is left.
  bool make(const volume::ScalarGrid& grid, Vec3i chunk, const volume::SampleBox& changed,
            std::uint64_t version, GridChunkState& state);

 private:
  /// Rows of a plane, or planes, both included.
  struct Rows {
    int first, last;
    bool has(int at) const { return at >= first && at <= last; }
  };
  /// Some rows in some planes.
  struct Part {
    Rows rows, planes;
  };

  void choose_parts(const volume::SampleBox& changed);
  void read(const volume::ScalarGrid& grid, const Part& part);
  void add_air(const Part& part);
  void update_bits();
  void count_vertices();
  std::uint64_t columns() const;
  std::uint64_t cut_voxels(int j, int k) const;
  /// The number of a row of voxels, and of a row of samples, of the block.
  int voxel_row(int j, int k) const { return k * (block_.samples.y - 1) + j; }
  int sample_row(int j, int k) const { return k * block_.samples.y + j; }
  /// Where the samples of a row begin.
  float* samples(int j, int k) const {
    return samples_ + std::ptrdiff_t{sample_row(j, k)} * block_.samples.x;
  }
  RowWord& word(int j, int k) {
    const int rows = fresh_.rows.last - fresh_.rows.first + 1;
    return words_[(k - fresh_.planes.first) * rows + j - fresh_.rows.first];
  }
  void make_triangles();
  void place_all(GridChunkMesh& out);
  void place_row_span(int k, GridChunkMesh& out);
  void point_walls_outward(int k, std::size_t n);
  void keep_vertices(std::size_t first_row, std::size_t end_row, GridChunkMesh& out) const;
  void gather_triangles(GridChunkMesh& out) const;
  template <class T>
  void keep_corners(int k, int first, std::size_t from, std::size_t to, const std::vector<T>& old,
                    std::vector<T>& out) const;
  void gather_polygons(GridChunkMesh& out);
  void keep_polygons(int k, int first, int end, VoxelPolygons& out) const;
  const std::uint32_t* join_polygons(int k, const std::uint32_t* corners, GridChunkMesh& out) const;
  template <class Keep, class Fresh>
  void for_voxel_rows(const Keep& keep, const Fresh& fresh) const;

  const GridLayout& layout_;
  const bool polygons_;
  GridLayout::Block block_;
  GridChunkState* state_ = nullptr;
  std::vector<std::uint32_t> vertex_at_, triangle_at_, voxel_at_;  ///< the state's, of the mesh in the making
  /// Samples that changed, rows of edges whose vertices' places or normals may differ, and rows of voxels
  /// whose triangles may differ by more than where vertices are.
  Part changed_{}, fresh_{}, recut_{};

  std::vector<float> memory_;  ///< the block, with slack on both ends
  float* samples_ = nullptr;
  Plane plane_;
  Buffer<EdgeKey> keys_;
  Buffer<float> positions_, normals_;
  Buffer<std::uint32_t> corners_;  ///< of the triangles of recut rows, in their order
  std::vector<RowWord> words_;     ///< of fresh rows
};

}  // namespace tafoni::surface::impl
