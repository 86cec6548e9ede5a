#pragma once
// The triangles of a prism-field's surface over a box of cells.

#include <utility>
#include <vector>

#include "tafoni/surface/prism_mesher.h"
#include "tafoni/volume/inner/prism_cells.h"

namespace tafoni::surface::impl {

struct PrismFace {
  std::int32_t column[3];  ///< places in the block
  std::int32_t level[3];   ///< places in cells().levels()
  PrismSurface surface;
};

/// Each thread has its own, whose memory is used again from run to run.
class PrismFaces {
 public:
  /// The faces of the cells from (box.i0, box.j0) to (box.i1, box.j1) and, if `ring`, of those around it, row
  /// by row. The faces of a cell do not depend on the box.
  const std::vector<PrismFace>& run(const volume::PrismFields& fields, const volume::ColumnBox& box,
                                    bool ring, volume::DeadPoints dead);
  /// Where the last run put the faces of the cells from (i, j) to (i_end - 1, j).
  std::pair<std::size_t, std::size_t> in_row(int i, int i_end, int j) const {
    const std::ptrdiff_t row = std::ptrdiff_t{j - meshed_.j0} * meshed_.width();
    const auto at = [&](int n) { return face_starts_[row + (n - meshed_.i0)]; };
    return {at(i), at(i_end)};
  }

  const volume::PrismCells& cells() const { return cells_; }
  const volume::ColumnBlock& block() const { return block_; }

 private:
  using Slab = volume::PrismCells::Slab;
  using Range = volume::PrismCells::Range;
  /// A part of a cell's side that is solid, between its corner a and the next, b.
  struct Quad {
    Range a, b;
    friend bool operator==(const Quad&, const Quad&) = default;
  };
  /// The place of a cell of known_ in starts_ and cuts_.
  std::ptrdiff_t cell(int i, int j) const {
    return std::ptrdiff_t{j - known_.j0} * known_.width() + (i - known_.i0);
  }
  std::span<const Slab> slabs(int i, int j) const;
  void caps(int i, int j, std::span<const Slab> all);
  void caps_of_triangle(std::span<const Slab> piece, const std::array<int, 3>& corners);
  void walls(int i, int j, int side, std::span<const Slab> all);
  void side_of(std::span<const Slab> all, int a, int b, std::vector<Quad>& out) const;
  void wall(std::int32_t a, std::int32_t b, const Quad& quad);
  void face(std::int32_t ca, std::int32_t la, std::int32_t cb, std::int32_t lb, std::int32_t cc,
            std::int32_t lc, PrismSurface surface);

  volume::ColumnBlock block_;
  volume::PrismCells cells_;
  volume::ColumnBox known_;   ///< cells whose slabs are known
  volume::ColumnBox meshed_;  ///< cells whose faces are
  std::vector<Slab> slabs_;
  std::vector<std::int32_t> starts_;
  std::vector<bool> cuts_;
  std::vector<Quad> here_, there_;
  std::vector<PrismFace> faces_;
  std::vector<std::size_t> face_starts_;   ///< by cell of meshed_
  std::array<std::int32_t, 4> columns_{};  ///< of the cell at work
};

}  // namespace tafoni::surface::impl
