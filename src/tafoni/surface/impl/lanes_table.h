#pragma once
// The case table as the triangle kernels read it.
//
// A cell's 12 edges are found among 16 lanes: lanes 0 to 7 hold, for the rows x00 x10 x01 x11 y0 y1 z0 z1,
// the index of the row's vertex at the cell's own column; lanes 8 to 15 that of the next column.

#include <cstddef>
#include <cstdint>

#include "tafoni/surface/impl/kernels.h"

namespace tafoni::surface::impl {

/// 16 bytes, so that one load fetches a case.
struct alignas(16) LaneCase {
  std::uint8_t lanes[15] = {};
  std::uint8_t indices = 0;
};
const LaneCase* lane_cases();

/// Those of `cells` whose corners differ; r: the rows (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1).
inline std::uint64_t cut_cells(const RowWord* const r[4], std::uint64_t cells) {
  if (!cells) return 0;
  std::uint64_t any = 0, all = ~std::uint64_t{0};
  for (int i = 0; i < 4; ++i) {
    any |= r[i]->solid | r[i]->next;
    all &= r[i]->solid & r[i]->next;
  }
  return any & ~all & cells;
}

/// triangles() for processors that count the bits of eight lanes at once (AVX-512 VPOPCNTDQ).
bool has_lane_popcount();
std::size_t triangles_by_lanes(const RowWord* lower, const RowWord* upper, const std::uint64_t* cells,
                               int rows, int words, std::uint32_t* out, std::uint64_t& cut);

}  // namespace tafoni::surface::impl
