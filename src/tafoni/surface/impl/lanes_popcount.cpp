// The triangle kernel for processors that count the bits of eight words at once: the twelve vertices of a
// cell by one count, its triangles by one permutation.

#include "tafoni/surface/impl/lanes_table.h"

#if defined(__x86_64__)
#if !defined(__clang__)
// GCC 12 warns about its own _mm512_undefined (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif
#include <immintrin.h>
#define TAFONI_LANES \
  __attribute__((target("popcnt,avx2,bmi,bmi2,avx512f,avx512dq,avx512bw,avx512vl,avx512vpopcntdq")))

namespace tafoni::surface::impl {

bool has_lane_popcount() {
  return __builtin_cpu_supports("avx512vpopcntdq") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("bmi2");
}

namespace {

TAFONI_LANES inline std::uint32_t* cells_of_word(const RowWord* const r[4], std::uint64_t active,
                                                 const LaneCase* cases, std::uint32_t* out) {
  const auto bits = _mm512_set_epi64(r[1]->z, r[0]->z, r[2]->y, r[0]->y, r[3]->x, r[2]->x, r[1]->x, r[0]->x);
  const auto solid = _mm512_set_epi64(r[3]->next, r[3]->solid, r[2]->next, r[2]->solid, r[1]->next,
                                      r[1]->solid, r[0]->next, r[0]->solid);
  const auto base = _mm256_set_epi32(r[1]->z_base, r[0]->z_base, r[2]->y_base, r[0]->y_base, r[3]->x_base,
                                     r[2]->x_base, r[1]->x_base, r[0]->x_base);
  while (active) {
    const std::uint64_t bit = active & (0 - active);
    active ^= bit;
    const auto at = _mm512_set1_epi64(bit);
    const auto below = _mm512_set1_epi64(bit - 1);
    const unsigned solid_corners = _cvtmask8_u32(_mm512_test_epi64_mask(solid, at));
    const auto rank = _mm512_cvtepi64_epi32(_mm512_popcnt_epi64(_mm512_and_si512(bits, below)));
    const auto index = _mm256_add_epi32(rank, base);
    const auto here = _mm512_test_epi64_mask(bits, at);
    const auto after = _mm256_mask_add_epi32(index, here, index, _mm256_set1_epi32(1));
    const auto lanes = _mm512_inserti64x4(_mm512_castsi256_si512(index), after, 1);
    const LaneCase& c = cases[solid_corners];
    const auto pick = _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(c.lanes)));
    _mm512_storeu_si512(out, _mm512_permutexvar_epi32(pick, lanes));
    out += c.indices;
  }
  return out;
}

}  // namespace

TAFONI_LANES std::size_t triangles_by_lanes(const RowWord* lower, const RowWord* upper,
                                            const std::uint64_t* cells, int rows, int words,
                                            std::uint32_t* out, std::uint64_t& cut) {
  std::uint32_t* const begin = out;
  const LaneCase* const cases = lane_cases();
  for (int at = 0; at < rows * words; ++at) {
    const RowWord* r[4] = {lower + at, lower + at + words, upper + at, upper + at + words};
    const std::uint64_t active = cut_cells(r, cells[at]);
    if (!active) continue;
    cut += _mm_popcnt_u64(active);
    out = cells_of_word(r, active, cases, out);
  }
  return out - begin;
}

}  // namespace tafoni::surface::impl

#else

namespace tafoni::surface::impl {

bool has_lane_popcount() {
  return false;
}
std::size_t triangles_by_lanes(const RowWord*, const RowWord*, const std::uint64_t*, int, int, std::uint32_t*,
                               std::uint64_t&) {
  return 0;
}

}  // namespace tafoni::surface::impl
#endif
