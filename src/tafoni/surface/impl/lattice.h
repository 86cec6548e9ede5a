#pragma once
// Which cells of the lattice are meshed, and where vertices may lie on its edges.

#include <bit>
#include <cstdint>
#include <vector>

#include "tafoni/field/chunks.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::surface::impl {

/// Least distance of a vertex from the ends of its edge, in edges: 1/128, or as much more as floats need to
/// keep vertices around a lattice point apart when coordinates reach `cells` edges from zero.
/// Throws Error{usage} where that is hopeless.
float margin_for(std::int64_t cells);

/// The cells to mesh: a box of the lattice, less the columns that the predicate leaves out. For a solid,
/// whole chunks, and no border is looked for since the surface must not reach it.
class CellSet {
 public:
  CellSet(const Box3d& bounds, const PolygonizeSettings& settings);

  struct Limits {
    Vec3i lo, hi;  ///< cells, hi exclusive
    friend bool operator==(const Limits&, const Limits&) = default;
  };
  /// The box of the set, without its columns.
  static Limits limits(const Box3d& bounds, const PolygonizeSettings& settings);
  Limits limits() const { return {lo_, hi_}; }

  /// Chunks that hold cells of the set, first to last.
  Vec3i first_chunk() const { return chunk_of(lo_); }
  Vec3i last_chunk() const { return chunk_of({hi_.x - 1, hi_.y - 1, hi_.z - 1}); }
  bool empty() const { return lo_.x >= hi_.x || lo_.y >= hi_.y || lo_.z >= hi_.z; }
  /// Greatest distance of a cell's corner from lattice point zero along an axis.
  std::int64_t reach() const;
  bool layer(int k) const { return k >= lo_.z && k < hi_.z; }
  bool column(int i, int j) const {
    if (i < lo_.x || i >= hi_.x || j < lo_.y || j >= hi_.y) return false;
    return columns_.empty() || ((columns_[word(i, j)] >> ((i - lo_.x) & 63)) & 1);
  }
  bool cell(int i, int j, int k) const { return layer(k) && column(i, j); }
  /// Cells i .. i + 63 of row j, as bits.
  std::uint64_t row(int i, int j) const;
  /// All cells i - 1 .. i + 64, j - 1 .. j + 64 and k - 1 .. k + 64 are in the set: no border in that chunk.
  bool whole_chunk(Vec3i first) const;

 private:
  std::ptrdiff_t word(int i, int j) const { return (j - lo_.y) * words_ + ((i - lo_.x) >> 6); }
  void choose_columns(const PolygonizeSettings& settings);
  bool drop_corner_contacts();

  static Vec3i chunk_of(Vec3i cell) {
    constexpr int shift = std::bit_width(unsigned{field::chunk_cells}) - 1;
    return {cell.x >> shift, cell.y >> shift, cell.z >> shift};
  }

  Vec3i lo_, hi_;                       ///< hi exclusive
  std::ptrdiff_t words_ = 0;            ///< a row of columns_
  std::vector<std::uint64_t> columns_;  ///< by row from lo_.y, bits from lo_.x; empty: every column
};

}  // namespace tafoni::surface::impl
