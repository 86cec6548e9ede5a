// What the core does to a plane of samples: reads signs where a cell around is looked at, finds the edges
// that carry a vertex by comparing words of bits, and lists them in the order of their vertices.

#include "tafoni/surface/impl/block.h"

#include <bit>

namespace tafoni::surface::impl {

void BlockWalker::read_signs(const float* plane, std::ptrdiff_t row_step, const std::uint64_t* known,
                             Layer below, Layer above, PlaneRows& out) {
  for (int j = 0; j < ny_; ++j) {
    std::uint64_t around = 0;
    for (int w = 0; w < words_; ++w)
      around |= below.at(j - 1, w, ny_, words_) | below.at(j, w, ny_, words_) |
                above.at(j - 1, w, ny_, words_) | above.at(j, w, ny_, words_);
    out.used[j] = around != 0;
    if (!around) continue;
    if (known)
      std::copy_n(known + j * words_, words_, bits_.begin());
    else
      signs(plane + j * row_step, nx_, 1, bits_.data());
    RowWord* row = out.words.data() + j * words_;
    for (int w = 0; w < words_; ++w) {
      row[w].solid = bits_[w];
      row[w].next = (bits_[w] >> 1) | (bits_[w + 1] << 63);
    }
  }
}

void BlockWalker::find_edges(Layer below, Layer above, PlaneRows& plane, const PlaneRows& next_plane) {
  for (int j = 0; j < ny_; ++j) {
    if (!plane.used[j]) continue;
    RowWord* row = plane.words.data() + j * words_;
    // The last row has no row beyond it, and no cells along it either.
    const RowWord* beyond = row + (j + 1 < ny_ ? words_ : 0);
    const RowWord* over = next_plane.words.data() + j * words_;
    std::uint64_t y_carry = 0, z_carry = 0;
    for (int w = 0; w < words_; ++w) {
      const std::uint64_t near_below = below.at(j - 1, w, ny_, words_),
                          far_below = below.at(j, w, ny_, words_);
      const std::uint64_t near_above = above.at(j - 1, w, ny_, words_),
                          far_above = above.at(j, w, ny_, words_);
      const std::uint64_t y_cells = far_below | far_above, z_cells = near_above | far_above;
      // An edge across the row belongs to the cells on both its sides in x.
      const std::uint64_t y_edges = y_cells | (y_cells << 1) | y_carry;
      const std::uint64_t z_edges = z_cells | (z_cells << 1) | z_carry;
      y_carry = y_cells >> 63, z_carry = z_cells >> 63;
      row[w].x = (row[w].solid ^ row[w].next) & (near_below | near_above | y_cells);
      row[w].y = (row[w].solid ^ beyond[w].solid) & y_edges;
      row[w].z = (row[w].solid ^ over[w].solid) & z_edges;
    }
  }
}

void BlockWalker::list_edges(PlaneRows& plane) {
  Buffer<EdgeKey>& keys = output_.keys;
  const auto list = [&](std::uint64_t bits, std::uint32_t& base, EdgeKey first) {
    base = count_;
    EdgeKey* out = keys.end();
    for (; bits; bits &= bits - 1) *out++ = first + std::countr_zero(bits);
    const int n = static_cast<int>(out - keys.end());
    keys.commit(n);
    count_ += n;
  };
  for (int j = 0; j < ny_; ++j) {
    if (!plane.used[j]) continue;
    RowWord* row = plane.words.data() + j * words_;
    keys.reserve_extra(3 * 64 * words_ + kernel_slack);
    for (int w = 0; w < words_; ++w) list(row[w].x, row[w].x_base, edge_key(64 * w, j, 0));
    for (int w = 0; w < words_; ++w) list(row[w].y, row[w].y_base, edge_key(64 * w, j, 1));
    for (int w = 0; w < words_; ++w) list(row[w].z, row[w].z_base, edge_key(64 * w, j, 2));
  }
  // The kernels read whole vectors of keys.
  keys.reserve_extra(kernel_slack);
  std::fill_n(keys.end(), kernel_slack, EdgeKey{0});
}

}  // namespace tafoni::surface::impl
