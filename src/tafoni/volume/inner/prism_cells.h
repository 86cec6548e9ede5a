#pragma once
// How the columns of a prism-field connect: the matter of one cell of the grid as slabs, each a prism between
// a bottom and a top at its corners.
//
// [Boggus] leaves open which of a column's intervals belongs to which layer where layers split, and so
// what is connected. Here matter connects where it overlaps: intervals of columns beside each other that
// share an elevation are one piece. So the solid is a function of the columns as sets, whatever tools in
// whatever order made them, and no slit opens where layers change hands. The price: the intervals of a sheet
// thinner than spacing * sin(slope) miss each other, and there it is gone; columns do not tell such a sheet
// from matter that ends here and begins anew there. Air between two slabs that ends beside a column, which is
// solid there, is pinched shut at a *seam*: a level inside that column's matter at the mean elevation of the
// air around. A piece of matter that lacks one corner of a cell (a dead point) fills the triangle of the
// others, one that lacks more nothing [Boggus fig. 6].

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tafoni/volume/prism_field.h"

namespace tafoni::volume {

/// The corners of cell (i, j) in order: columns (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1).
inline constexpr int cell_corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/// The place that the next item of a list gets; lists of a cell's parts are far shorter than 2^31.
template <class T>
std::int32_t end_of(const std::vector<T>& items) {
  return static_cast<std::int32_t>(items.size());
}

class PrismCells {
 public:
  /// Levels are elevations of one column, bottom first: ends of its matter and seams.
  struct Range {
    std::int32_t first = 0, last = 0;  ///< places in levels(); equal where a slab ends in an edge
    friend bool operator==(const Range&, const Range&) = default;
  };
  /// Slabs of a piece of matter that lie on each other at all corners of a triangle are one body there.
  struct Slab {
    std::array<Range, 4> at;
    std::uint8_t corners = 0;  ///< bit k: the slab has corner k; 15 or three of them
    std::int32_t piece =
        0;  ///< the same for slabs of one connected piece of matter of the cell, bottom first
  };

  /// Levels and seams of the columns of `block`. Those of its outermost columns lack the seams that columns
  /// beyond would make.
  void build(const ColumnBlock& block);
  /// Of a cell whose corners are in the block. Valid until the next call.
  std::span<const Slab> slabs(int i, int j, DeadPoints dead);

  std::span<const float> levels() const { return levels_; }
  float level(int place) const { return levels_[place]; }
  /// The place of column (i, j)'s first level.
  std::int32_t first_level(int i, int j) const { return starts_[block_->column(i, j)]; }

  /// Whether a cell of these slabs is cut from corner 0 to 2 (else from 1 to 3) into triangles: the flatter
  /// way over the uppermost slab.
  bool cut_0_to_2(std::span<const Slab> slabs) const;

 private:
  struct Gap {
    float lo, hi;
    int corner;
    Range ends;  ///< last level of the matter below, first of that above
    int set;
  };
  struct Seam {
    float lo, hi;  ///< of all the air that is pinched there
    std::int32_t place;
  };
  void find_air();
  void column(int i, int j);
  void seams_of(int i, int j, const Matter& matter);
  bool simple(const std::array<std::size_t, 4>& columns, Slab& slab) const;
  void pieces(const std::array<std::size_t, 4>& columns);
  void emit(const std::array<std::size_t, 4>& columns, std::int32_t root, DeadPoints dead);
  void split(const std::array<std::size_t, 4>& columns, std::int32_t root, Slab whole);
  Range cut(std::size_t column, int interval, const Gap& gap) const;
  const Matter& matter(std::size_t column, int n) const {
    return block_->intervals[column * block_->stride + n];
  }
  Range range(std::size_t column, int n) const { return ranges_[column * block_->stride + n]; }

  const ColumnBlock* block_ = nullptr;
  std::vector<float> levels_;
  std::vector<std::int32_t> starts_;       ///< by column
  std::vector<Range> ranges_;              ///< by column and interval
  std::vector<Seam> seams_;                ///< by column
  std::vector<std::int32_t> seam_starts_;  ///< by column
  std::vector<std::pair<float, float>> air_;
  std::vector<std::uint8_t> near_air_;  ///< by column
  struct Node {
    int corner, interval;
    std::int32_t root;
  };
  std::vector<Node> nodes_;
  std::array<std::int32_t, 5> node_starts_{};
  std::vector<Gap> gaps_;
  std::vector<Slab> slabs_;
};

}  // namespace tafoni::volume
