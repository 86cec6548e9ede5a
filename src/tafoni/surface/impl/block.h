#pragma once
// The polygonizer's core: one block of samples, plane by plane. Chunks and dense grids both go through it.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tafoni/math/simd.h"
#include "tafoni/surface/impl/buffer.h"
#include "tafoni/surface/impl/kernels.h"

namespace tafoni::surface::impl {

/// What one plane of the block adds to the output; memory is reused from plane to plane.
struct PlaneOutput {
  Buffer<EdgeKey> keys;
  std::uint32_t first = 0;  ///< index of the plane's first vertex
  Buffer<std::uint32_t> indices;
};

/// Walks the planes of a block of nx * ny * nz samples.
///
/// Cells: `bool layer(k)`, whether layer k has any cell to look at, false outside; and
/// `const uint64_t* rows(k)`, (ny - 1) rows of (nx + 63) / 64 words of cells, for such a layer.
/// Sink: `void vertices(int k, const PlaneOutput&)`, once plane k's vertices are known, and
/// `void triangles(const PlaneOutput&)`, for the layer below plane k; both in order of k.
class BlockWalker {
 public:
  BlockWalker() { limit_simd(); }

  /// `signs`: the solid bits of all samples, (nx + 63) / 64 words a row, where they are known already; or
  /// null.
  template <class Cells, class Sink>
  void walk(const float* f, int nx, int ny, int nz, std::ptrdiff_t row_step, std::ptrdiff_t plane_step,
            const Cells& cells, Sink& sink, const std::uint64_t* signs = nullptr);

  std::uint64_t cut_cells() const { return cut_; }
  std::uint32_t vertex_count() const { return count_; }

 private:
  struct Layer {
    const std::uint64_t* rows = nullptr;  ///< null: no cells
    std::uint64_t at(int j, int w, int ny, int words) const {
      return rows && j >= 0 && j < ny - 1 ? rows[j * words + w] : 0;
    }
  };

  struct PlaneRows {
    std::vector<RowWord> words;
    std::vector<std::uint8_t> used;  ///< by row: some cell around it is looked at, so its samples are valid
  };

  void read_signs(const float* plane, std::ptrdiff_t row_step, const std::uint64_t* signs, Layer below,
                  Layer above, PlaneRows& out);
  void find_edges(Layer below, Layer above, PlaneRows& plane, const PlaneRows& next_plane);
  void list_edges(PlaneRows& plane);

  int nx_ = 0, ny_ = 0, words_ = 0;
  std::uint32_t count_ = 0;
  std::uint64_t cut_ = 0;
  PlaneRows planes_[3];
  std::vector<std::uint64_t> bits_;
  PlaneOutput output_;
};

template <class Cells, class Sink>
void BlockWalker::walk(const float* f, int nx, int ny, int nz, std::ptrdiff_t row_step,
                       std::ptrdiff_t plane_step, const Cells& cells, Sink& sink,
                       const std::uint64_t* signs) {
  nx_ = nx, ny_ = ny, words_ = (nx + 63) / 64;
  count_ = 0, cut_ = 0;
  for (PlaneRows& plane : planes_) {
    plane.words.resize(std::ptrdiff_t{ny} * words_);
    plane.used.resize(ny);
  }
  bits_.assign(words_ + 1, 0);
  const auto layer = [&](int k) { return Layer{cells.layer(k) ? cells.rows(k) : nullptr}; };
  const auto plane = [&](int k) -> PlaneRows& { return planes_[k % 3]; };
  const std::size_t most = std::size_t{15 * 64} * ny * words_;
  const auto read = [&](int k) {
    const std::uint64_t* known = signs ? signs + std::ptrdiff_t{k} * ny * words_ : nullptr;
    read_signs(f + k * plane_step, row_step, known, layer(k - 1), layer(k), plane(k));
  };
  for (int k = 0; k < nz; ++k) {
    const Layer below = layer(k - 1), above = layer(k);
    if (!below.rows && !above.rows) continue;
    if (!below.rows) read(k);
    if (above.rows) read(k + 1);
    find_edges(below, above, plane(k), plane(k + 1));
    output_.keys.clear();
    output_.first = count_;
    list_edges(plane(k));
    sink.vertices(k, output_);
    if (!below.rows) continue;
    output_.indices.clear();
    output_.indices.reserve_extra(most);
    output_.indices.commit(triangles(plane(k - 1).words.data(), plane(k).words.data(), below.rows, ny - 1,
                                     words_, output_.indices.data(), cut_));
    sink.triangles(output_);
  }
}

}  // namespace tafoni::surface::impl
