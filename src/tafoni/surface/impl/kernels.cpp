// The inner loops, compiled once for each instruction set by Highway: signs of samples as bits, vertices and
// their normals by whole vectors, triangles by counting bits.

#include "tafoni/surface/impl/kernels.h"

#include <algorithm>

#include <hwy/highway.h>

#include "tafoni/math/simd.h"
#include "tafoni/surface/impl/lanes_table.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::surface::impl {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE void signs_of_row(const float* f, int samples, std::uint64_t* words) {
  const hn::ScalableTag<float> d;
  const auto zero = hn::Zero(d);
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int begin = 0; begin < samples; begin += 64) {
    std::uint64_t word = 0;
    const int end = samples - begin < 64 ? samples - begin : 64;
    int i = 0;
    for (; i + lanes <= end; i += lanes) {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Gt(hn::LoadU(d, f + begin + i), zero), bits);
      std::uint64_t m = 0;
      __builtin_memcpy(&m, bits, sizeof m);
      word |= m << i;
    }
    for (; i < end; ++i) word |= std::uint64_t{f[begin + i] > 0.0f} << i;
    *words++ = word;
  }
}

void signs_kernel(const float* f, int samples, int rows, std::uint64_t* words) {
  for (int row = 0; row < rows; ++row, f += samples, words += (samples + 63) / 64)
    signs_of_row(f, samples, words);
}

std::uint64_t differences_kernel(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) {
  std::uint64_t count = 0;
  for (std::size_t w = 0; w < words; ++w) count += __builtin_popcountll(a[w] ^ b[w]);
  return count;
}

std::uint32_t row_words_kernel(const std::uint64_t* solid, const std::uint64_t* above, int rows,
                               std::uint64_t cells, std::uint64_t samples, std::uint32_t base, RowWord* out) {
  const auto count = [](std::uint64_t word) -> std::uint32_t { return __builtin_popcountll(word); };
  for (int j = 0; j < rows; ++j, ++out) {
    out->solid = solid[j];
    out->next = solid[j] >> 1;
    out->x = (solid[j] ^ out->next) & cells;
    out->y = (solid[j] ^ solid[j + 1]) & samples;
    out->z = above ? (solid[j] ^ above[j]) & samples : 0;
    out->x_base = base;
    out->y_base = out->x_base + count(out->x);
    out->z_base = out->y_base + count(out->y);
    base = out->z_base + count(out->z);
  }
  return base;
}

using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using D = hn::ScalableTag<double>;
using FloatVec = hn::Vec<F>;
using IntVec = hn::Vec<I>;

/// Doubles of as many lanes as FloatVec, in two vectors where one cannot hold them.
#if HWY_TARGET == HWY_SCALAR
struct Doubles {
  hn::Vec<D> lower;
};
HWY_INLINE Doubles coordinate(IntVec index, FloatVec t, double first, double voxel, double origin) {
  const D d;
  const auto at = hn::Add(hn::Add(hn::Set(d, first), hn::PromoteTo(d, index)), hn::PromoteTo(d, t));
  return {hn::Add(hn::Mul(at, hn::Set(d, voxel)), hn::Set(d, origin))};
}
HWY_INLINE FloatVec to_floats(Doubles p) {
  return hn::DemoteTo(F(), p.lower);
}
HWY_INLINE void store_points(Doubles x, Doubles y, Doubles z, double* out) {
  hn::StoreInterleaved3(x.lower, y.lower, z.lower, D(), out);
}
#else
struct Doubles {
  hn::Vec<D> lower, upper;
};
/// (first + index + t) * voxel + origin
HWY_INLINE Doubles coordinate(IntVec index, FloatVec t, double first, double voxel, double origin) {
  const D d;
  const hn::Half<F> hf;
  const hn::Half<I> hi;
  const auto base = hn::Set(d, first), scale = hn::Set(d, voxel), zero = hn::Set(d, origin);
  const auto one = [&](auto i, auto s) HWY_ATTR {
    return hn::Add(hn::Mul(hn::Add(hn::Add(base, hn::PromoteTo(d, i)), hn::PromoteTo(d, s)), scale), zero);
  };
  return {one(hn::LowerHalf(hi, index), hn::LowerHalf(hf, t)),
          one(hn::UpperHalf(hi, index), hn::UpperHalf(hf, t))};
}
HWY_INLINE FloatVec to_floats(Doubles p) {
  const hn::Half<F> hf;
  return hn::Combine(F(), hn::DemoteTo(hf, p.upper), hn::DemoteTo(hf, p.lower));
}
HWY_INLINE void store_points(Doubles x, Doubles y, Doubles z, double* out) {
  const D d;
  hn::StoreInterleaved3(x.lower, y.lower, z.lower, d, out);
  hn::StoreInterleaved3(x.upper, y.upper, z.upper, d, out + 3 * hn::Lanes(d));
}
#endif

// Gather instructions are slower than plain loads on most processors, so samples are collected one by one
// into short columns first, then worked on by whole vectors.
constexpr std::size_t batch = 64;
struct Columns {
  alignas(64) float f0[batch], f1[batch];
  alignas(64) float gradient[2][3][batch];  ///< by end and axis: twice the difference per edge
};

HWY_INLINE void collect_ends(const Plane& p, const EdgeKey* keys, std::size_t n, Columns& out) {
  const std::ptrdiff_t steps[] = {1, p.row_step, p.plane_step};
  for (std::size_t v = 0; v < n; ++v) {
    const EdgeKey key = keys[v];
    const float* at = p.f + key_i(key) + std::ptrdiff_t{key_j(key)} * p.row_step;
    out.f0[v] = at[0];
    out.f1[v] = at[steps[key_axis(key)]];
  }
}

/// Twice the difference of samples per edge along one axis; it is one-sided at the grid's faces.
HWY_INLINE float difference(const float* at, int index, int first, int end, std::ptrdiff_t step) {
  if (index == first) return 2 * (at[step] - at[0]);
  if (index == end - 1) return 2 * (at[0] - at[-step]);
  return at[step] - at[-step];
}

HWY_INLINE void collect_gradients(const Plane& p, const EdgeKey* keys, std::size_t n, Columns& out) {
  const std::ptrdiff_t row = p.row_step, layer = p.plane_step, steps[] = {1, row, layer};
  const auto within = [](int index, int first, int end) {
    return static_cast<unsigned>(index - first - 1) < static_cast<unsigned>(std::max(end - first - 3, 0));
  };
  const bool inner_plane = within(p.k, p.z0, p.nz);
  for (std::size_t v = 0; v < n; ++v) {
    const int i = key_i(keys[v]), j = key_j(keys[v]), axis = key_axis(keys[v]);
    const float* ends[2];
    ends[0] = p.f + i + std::ptrdiff_t{j} * row;
    ends[1] = ends[0] + steps[axis];
    if (inner_plane && within(i, p.x0, p.nx) && within(j, p.y0, p.ny)) {
      for (int e = 0; e < 2; ++e) {
        const float* at = ends[e];
        out.gradient[e][0][v] = at[1] - at[-1];
        out.gradient[e][1][v] = at[row] - at[-row];
        out.gradient[e][2][v] = at[layer] - at[-layer];
      }
      continue;
    }
    for (int e = 0; e < 2; ++e) {
      out.gradient[e][0][v] = difference(ends[e], i + (axis == 0 ? e : 0), p.x0, p.nx, 1);
      out.gradient[e][1][v] = difference(ends[e], j + (axis == 1 ? e : 0), p.y0, p.ny, row);
      out.gradient[e][2][v] = difference(ends[e], p.k + (axis == 2 ? e : 0), p.z0, p.nz, layer);
    }
  }
}

/// Minus the gradient, of unit length; where it vanishes, the edge's own direction towards air.
HWY_INLINE void store_normals(const Columns& c, std::size_t v, FloatVec t, IntVec axis, FloatVec f0,
                              float* out) {
  const F df;
  const I di;
  const auto mix = [&](std::size_t along) HWY_ATTR {
    const auto a = hn::LoadU(df, c.gradient[0][along] + v), b = hn::LoadU(df, c.gradient[1][along] + v);
    return hn::Add(a, hn::Mul(t, hn::Sub(b, a)));
  };
  const auto x = mix(0), y = mix(1), z = mix(2);
  const auto squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const auto good = hn::Gt(squared, hn::Set(df, 1e-30f));
  const auto scale = hn::Div(hn::Set(df, -1.0f), hn::Sqrt(squared));
  const auto toward_air = hn::IfThenElse(hn::Gt(f0, hn::Zero(df)), hn::Set(df, 1.0f), hn::Set(df, -1.0f));
  const auto pick = [&](FloatVec value, int wanted) HWY_ATTR {
    const auto along = hn::RebindMask(df, hn::Eq(axis, hn::Set(di, wanted)));
    return hn::IfThenElse(good, hn::Mul(value, scale), hn::IfThenElseZero(along, toward_air));
  };
  hn::StoreInterleaved3(pick(x, 0), pick(y, 1), pick(z, 2), df, out);
}

void place_batch(const Plane& plane, const EdgeKey* keys, const Columns& columns, std::size_t n,
                 float* positions, double* points, float* normals) {
  const F df;
  const I di;
  const auto low = hn::Set(df, plane.margin), high = hn::Set(df, 1.0f - plane.margin);
  for (std::size_t v = 0; v < n; v += hn::Lanes(df)) {
    const auto key = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(keys + v));
    const auto field = hn::Set(di, 0xfff);
    const auto i = hn::And(key, field), j = hn::And(hn::ShiftRight<12>(key), field);
    const auto axis = hn::ShiftRight<24>(key);
    const auto f0 = hn::LoadU(df, columns.f0 + v), f1 = hn::LoadU(df, columns.f1 + v);
    const auto ratio = hn::Div(f0, hn::Sub(f0, f1));
    const auto sane = hn::IfThenElse(hn::Eq(ratio, ratio), ratio, hn::Set(df, 0.5f));
    const auto t = hn::Min(hn::Max(sane, low), high);
    const auto along = [&](int wanted) HWY_ATTR {
      return hn::IfThenElseZero(hn::RebindMask(df, hn::Eq(axis, hn::Set(di, wanted))), t);
    };
    const auto x = coordinate(i, along(0), plane.i0, plane.voxel, plane.origin.x);
    const auto y = coordinate(j, along(1), plane.j0, plane.voxel, plane.origin.y);
    const auto z = coordinate(hn::Zero(di), along(2), plane.level, plane.voxel, plane.origin.z);
    hn::StoreInterleaved3(to_floats(x), to_floats(y), to_floats(z), df, positions + 3 * v);
    if (points) store_points(x, y, z, points + 3 * v);
    if (normals) store_normals(columns, v, t, axis, f0, normals + 3 * v);
  }
}

void place_kernel(const Plane& plane, const EdgeKey* keys, std::size_t n, float* positions, double* points,
                  float* normals) {
  Columns columns{};
  for (std::size_t v = 0; v < n; v += batch) {
    const std::size_t count = std::min(batch, n - v);
    collect_ends(plane, keys + v, count, columns);
    if (normals) collect_gradients(plane, keys + v, count, columns);
    place_batch(plane, keys + v, columns, count, positions + 3 * v, points ? points + 3 * v : nullptr,
                normals ? normals + 3 * v : nullptr);
  }
}

HWY_INLINE std::uint32_t* cells_of_word(const RowWord* r[4], std::uint64_t active, const LaneCase* cases,
                                        std::uint32_t* out) {
  const std::uint64_t bits[8] = {r[0]->x, r[1]->x, r[2]->x, r[3]->x, r[0]->y, r[2]->y, r[0]->z, r[1]->z};
  const std::uint32_t base[8] = {r[0]->x_base, r[1]->x_base, r[2]->x_base, r[3]->x_base,
                                 r[0]->y_base, r[2]->y_base, r[0]->z_base, r[1]->z_base};
  while (active) {
    const int i = __builtin_ctzll(active);
    const std::uint64_t below = (std::uint64_t{1} << i) - 1;
    active &= active - 1;
    std::uint32_t lanes[16];
    for (int row = 0; row < 8; ++row) {
      lanes[row] = base[row] + __builtin_popcountll(bits[row] & below);
      lanes[row + 8] = lanes[row] + static_cast<std::uint32_t>((bits[row] >> i) & 1);
    }
    unsigned solid_corners = 0;
    for (int row = 0; row < 4; ++row)
      solid_corners |= static_cast<unsigned>(((r[row]->solid >> i) & 1) | (((r[row]->next >> i) & 1) << 1))
                       << (2 * row);
    const LaneCase& c = cases[solid_corners];
    for (int e = 0; e < c.indices; ++e) out[e] = lanes[c.lanes[e]];
    out += c.indices;
  }
  return out;
}

std::size_t triangles_kernel(const RowWord* lower, const RowWord* upper, const std::uint64_t* cells, int rows,
                             int words, std::uint32_t* out, std::uint64_t& cut) {
  std::uint32_t* const begin = out;
  const LaneCase* const cases = lane_cases();
  for (int at = 0; at < rows * words; ++at) {
    const RowWord* r[4] = {lower + at, lower + at + words, upper + at, upper + at + words};
    const std::uint64_t active = cut_cells(r, cells[at]);
    if (!active) continue;
    cut += __builtin_popcountll(active);
    out = cells_of_word(r, active, cases, out);
  }
  return out - begin;
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::surface::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "tafoni/surface/impl/cases.h"

namespace tafoni::surface::impl {

HWY_EXPORT(signs_kernel);
HWY_EXPORT(differences_kernel);
HWY_EXPORT(row_words_kernel);
HWY_EXPORT(place_kernel);
HWY_EXPORT(triangles_kernel);

const LaneCase* lane_cases() {
  static const auto table = [] {
    // The lane of each edge: that of the row it belongs to, plus 8 for the far column.
    constexpr std::uint8_t lane_of[12] = {0, 1, 2, 3, 4, 12, 5, 13, 6, 14, 7, 15};
    std::array<LaneCase, 256> cases{};
    for (std::size_t c = 0; c < 256; ++c) {
      const CellCase& from = case_table()[c];
      cases[c].indices = static_cast<std::uint8_t>(3 * from.triangles);
      for (std::size_t e = 0; e < cases[c].indices; ++e) cases[c].lanes[e] = lane_of[from.edges[e]];
    }
    return cases;
  }();
  return table.data();
}

void signs(const float* f, int samples, int rows, std::uint64_t* words) {
  HWY_DYNAMIC_DISPATCH(signs_kernel)(f, samples, rows, words);
}

std::uint64_t count_differences(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) {
  return HWY_DYNAMIC_DISPATCH(differences_kernel)(a, b, words);
}

std::uint32_t row_words(const std::uint64_t* solid, const std::uint64_t* above, int rows, std::uint64_t cells,
                        std::uint64_t samples, std::uint32_t base, RowWord* out) {
  return HWY_DYNAMIC_DISPATCH(row_words_kernel)(solid, above, rows, cells, samples, base, out);
}

void place(const Plane& plane, const EdgeKey* keys, std::size_t n, float* positions, double* points,
           float* normals) {
  HWY_DYNAMIC_DISPATCH(place_kernel)(plane, keys, n, positions, points, normals);
}

std::size_t triangles(const RowWord* lower, const RowWord* upper, const std::uint64_t* cells, int rows,
                      int words, std::uint32_t* out, std::uint64_t& cut) {
  static const bool by_lanes = simd_name() == "avx512" && has_lane_popcount();
  if (by_lanes) return triangles_by_lanes(lower, upper, cells, rows, words, out, cut);
  return HWY_DYNAMIC_DISPATCH(triangles_kernel)(lower, upper, cells, rows, words, out, cut);
}

}  // namespace tafoni::surface::impl
#endif
