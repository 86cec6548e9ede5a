#pragma once
// The three inner loops of the polygonizer, compiled for every instruction set.

#include <cstddef>
#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni::surface::impl {

/// 64 samples of one row of the lattice: which are solid, which edges that start there carry a vertex, and
/// the index of the first vertex of each kind. A vertex's index is its base plus the number of set bits
/// below its own, so no table of edges is needed. A row's vertices of one kind have consecutive indices.
struct alignas(64) RowWord {
  std::uint64_t solid = 0, next = 0;  ///< bit i: sample i, sample i + 1
  std::uint64_t x = 0, y = 0, z = 0;  ///< bit i: the edge from sample i along the axis
  std::uint32_t x_base = 0, y_base = 0, z_base = 0;
};

/// Bits of f > 0 of `rows` rows of `samples` samples, one after the other; each row begins a word, and the
/// bits beyond its samples are 0.
void signs(const float* f, int samples, int rows, std::uint64_t* words);

/// Number of places in which two runs of words differ.
std::uint64_t count_differences(const std::uint64_t* a, const std::uint64_t* b, std::size_t words);

/// Fills `out` for `rows` rows of a block of at most 63 samples a row, from the solid bits of them and the
/// row after, one word each, and those of the plane above, or null where no edge leads there. x edges are
/// taken in `cells`, others in `samples`. Vertices are numbered from `base`; returns the number after the
/// last.
std::uint32_t row_words(const std::uint64_t* solid, const std::uint64_t* above, int rows, std::uint64_t cells,
                        std::uint64_t samples, std::uint32_t base, RowWord* out);

/// A vertex within a plane of samples: column i, row j and axis of its edge.
using EdgeKey = std::uint32_t;
constexpr EdgeKey edge_key(int i, int j, int axis) {
  return i | (j << 12) | (axis << 24);
}
constexpr int key_i(EdgeKey key) {
  return key & 0xfff;
}
constexpr int key_j(EdgeKey key) {
  return (key >> 12) & 0xfff;
}
constexpr int key_axis(EdgeKey key) {
  return key >> 24;
}

/// Elements that kernels may write beyond the last one.
inline constexpr std::size_t kernel_slack = 64;

struct Plane {
  const float* f = nullptr;  ///< sample (0, 0) of the plane
  std::int32_t row_step = 0, plane_step = 0;
  int x0 = 0, y0 = 0, z0 = 0, nx = 0, ny = 0, nz = 0;  ///< first sample and the end, for grid normals
  int k = 0;                                           ///< of the plane
  double i0 = 0, j0 = 0, level = 0;                    ///< lattice coordinates of sample (0, 0)
  double voxel = 1;
  Vec3d origin;      ///< of the lattice, metres
  float margin = 0;  ///< least distance of a vertex from its edge's ends, in edges
};

/// Positions of `n` vertices. `keys` is padded with zeros by kernel_slack; outputs have slack.
/// Each output may be null: 3 floats a position, 3 doubles a point (the same, unrounded), 3 floats a normal
/// (minus the central differences of the samples, interpolated along the edge; one-sided at the first and the
/// last sample). An edge may have an end beyond those; its normal means nothing then, and one sample more is
/// read.
void place(const Plane& plane, const EdgeKey* keys, std::size_t n, float* positions, double* points,
           float* normals);

/// Triangles of a layer of cells between the rows of two planes. `cells`: the cells to look at, as `rows`
/// rows of `words` words; rows of `lower` and `upper` are laid out the same and number rows + 1.
/// Returns the number of indices written (3 a triangle); `cut` counts the cells cut.
std::size_t triangles(const RowWord* lower, const RowWord* upper, const std::uint64_t* cells, int rows,
                      int words, std::uint32_t* out, std::uint64_t& cut);

}  // namespace tafoni::surface::impl
