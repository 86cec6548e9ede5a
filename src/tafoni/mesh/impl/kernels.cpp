#include "tafoni/mesh/impl/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/mesh/impl/kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include <hwy/highway.h>

#include "tafoni/mesh/impl/lanes_table.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::mesh::impl {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void signs_kernel(const float* f, int samples, std::uint64_t* words) {
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
    for (; i < end; ++i) word |= static_cast<std::uint64_t>(f[begin + i] > 0.0f) << i;
    *words++ = word;
  }
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
HWY_INLINE Doubles coordinate(IntVec index, FloatVec t, double origin, double voxel) {
  const D d;
  const auto at = hn::Add(hn::Add(hn::Set(d, origin), hn::PromoteTo(d, index)), hn::PromoteTo(d, t));
  return {hn::Mul(at, hn::Set(d, voxel))};
}
HWY_INLINE FloatVec rounded(Doubles p) {
  return hn::DemoteTo(F(), p.lower);
}
HWY_INLINE void store_points(Doubles x, Doubles y, Doubles z, double* out) {
  hn::StoreInterleaved3(x.lower, y.lower, z.lower, D(), out);
}
#else
struct Doubles {
  hn::Vec<D> lower, upper;
};
/// (origin + index + t) * voxel
HWY_INLINE Doubles coordinate(IntVec index, FloatVec t, double origin, double voxel) {
  const D d;
  const hn::Half<F> hf;
  const hn::Half<I> hi;
  const auto base = hn::Set(d, origin), scale = hn::Set(d, voxel);
  const auto one = [&](auto i, auto s) HWY_ATTR {
    return hn::Mul(hn::Add(hn::Add(base, hn::PromoteTo(d, i)), hn::PromoteTo(d, s)), scale);
  };
  return {one(hn::LowerHalf(hi, index), hn::LowerHalf(hf, t)),
          one(hn::UpperHalf(hi, index), hn::UpperHalf(hf, t))};
}
HWY_INLINE FloatVec rounded(Doubles p) {
  const hn::Half<F> hf;
  return hn::Combine(F(), hn::DemoteTo(hf, p.upper), hn::DemoteTo(hf, p.lower));
}
HWY_INLINE void store_points(Doubles x, Doubles y, Doubles z, double* out) {
  const D d;
  hn::StoreInterleaved3(x.lower, y.lower, z.lower, d, out);
  hn::StoreInterleaved3(x.upper, y.upper, z.upper, d, out + 3 * hn::Lanes(d));
}
#endif

struct Gradient {
  FloatVec x, y, z;
};

/// Difference of the samples on both sides along one axis, per cell; one-sided at the grid's faces.
HWY_INLINE FloatVec difference(const float* f, IntVec at, IntVec index, int count, int step) {
  const F df;
  const I di;
  const auto zero = hn::Zero(di), steps = hn::Set(di, step);
  const auto first = hn::Eq(index, zero);
  const auto last = hn::Eq(index, hn::Set(di, count - 1));
  const auto before = hn::Sub(at, hn::IfThenZeroElse(first, steps));
  const auto after = hn::Add(at, hn::IfThenZeroElse(last, steps));
  const auto span = hn::Sub(hn::GatherIndex(df, f, after), hn::GatherIndex(df, f, before));
  const auto border = hn::RebindMask(df, hn::Or(first, last));
  return hn::Mul(span, hn::IfThenElse(border, hn::Set(df, 1.0f), hn::Set(df, 0.5f)));
}

HWY_INLINE Gradient gradient(const Plane& p, IntVec at, IntVec i, IntVec j, IntVec k) {
  return {difference(p.f, at, i, p.nx, 1), difference(p.f, at, j, p.ny, p.row_step),
          difference(p.f, at, k, p.nz, p.plane_step)};
}

/// Minus the gradient, of unit length; where it vanishes, the edge's own direction towards air.
HWY_INLINE void store_normals(Gradient a, Gradient b, FloatVec t, IntVec axis, FloatVec f0, float* out) {
  const F df;
  const I di;
  const auto mix = [&](FloatVec u, FloatVec v) HWY_ATTR { return hn::Add(u, hn::Mul(t, hn::Sub(v, u))); };
  const auto x = mix(a.x, b.x), y = mix(a.y, b.y), z = mix(a.z, b.z);
  const auto squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const auto good = hn::Gt(squared, hn::Set(df, 1e-30f));
  const auto scale = hn::Div(hn::Set(df, -1.0f), hn::Sqrt(squared));
  const auto toward_air = hn::IfThenElse(hn::Gt(f0, hn::Zero(df)), hn::Set(df, 1.0f), hn::Set(df, -1.0f));
  const auto pick = [&](FloatVec v, int wanted) HWY_ATTR {
    const auto along = hn::RebindMask(df, hn::Eq(axis, hn::Set(di, wanted)));
    return hn::IfThenElse(good, hn::Mul(v, scale), hn::IfThenElseZero(along, toward_air));
  };
  hn::StoreInterleaved3(pick(x, 0), pick(y, 1), pick(z, 2), df, out);
}

void place_kernel(const Plane& plane, const EdgeKey* keys, std::size_t n, float* positions, double* points,
                  float* normals) {
  const F df;
  const I di;
  const std::size_t lanes = hn::Lanes(df);

  const auto low = hn::Set(df, plane.margin), high = hn::Set(df, 1.0f - plane.margin);
  const auto row = hn::Set(di, plane.row_step), layer = hn::Set(di, plane.plane_step);
  for (std::size_t v = 0; v < n; v += lanes) {
    const auto key = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(keys + v));
    const auto field = hn::Set(di, 0xfff);
    const auto i = hn::And(key, field), j = hn::And(hn::ShiftRight<12>(key), field);
    const auto axis = hn::ShiftRight<24>(key);
    const auto on_x = hn::Eq(axis, hn::Zero(di)), on_y = hn::Eq(axis, hn::Set(di, 1));
    const auto on_z = hn::Eq(axis, hn::Set(di, 2));
    const auto at = hn::Add(i, hn::Mul(j, row));
    const auto other = hn::Add(at, hn::IfThenElse(on_x, hn::Set(di, 1), hn::IfThenElse(on_y, row, layer)));
    const auto f0 = hn::GatherIndex(df, plane.f, at), f1 = hn::GatherIndex(df, plane.f, other);
    const auto ratio = hn::Div(f0, hn::Sub(f0, f1));
    const auto sane = hn::IfThenElse(hn::Eq(ratio, ratio), ratio, hn::Set(df, 0.5f));
    const auto t = hn::Min(hn::Max(sane, low), high);
    const auto tx = hn::IfThenElseZero(hn::RebindMask(df, on_x), t);
    const auto ty = hn::IfThenElseZero(hn::RebindMask(df, on_y), t);
    const auto tz = hn::IfThenElseZero(hn::RebindMask(df, on_z), t);
    const auto x = coordinate(i, tx, plane.i0, plane.voxel), y = coordinate(j, ty, plane.j0, plane.voxel);
    const auto z = coordinate(hn::Zero(di), tz, plane.level, plane.voxel);
    hn::StoreInterleaved3(rounded(x), rounded(y), rounded(z), df, positions + 3 * v);
    if (points) store_points(x, y, z, points + 3 * v);
    if (normals) {
      const auto unit = hn::Set(di, 1), k = hn::Set(di, plane.k);
      const auto add = [&](IntVec a, auto mask)
                           HWY_ATTR { return hn::Add(a, hn::IfThenElseZero(mask, unit)); };
      store_normals(gradient(plane, at, i, j, k),
                    gradient(plane, other, add(i, on_x), add(j, on_y), add(k, on_z)), t, axis, f0,
                    normals + 3 * v);
    }
  }
}

HWY_INLINE std::uint32_t* cells_of_word(const RowWord* r[4], std::uint64_t active, std::uint32_t* out) {
  const std::uint64_t bits[8] = {r[0]->x, r[1]->x, r[2]->x, r[3]->x, r[0]->y, r[2]->y, r[0]->z, r[1]->z};
  const std::uint32_t base[8] = {r[0]->x_base, r[1]->x_base, r[2]->x_base, r[3]->x_base,
                                 r[0]->y_base, r[2]->y_base, r[0]->z_base, r[1]->z_base};
  while (active) {
    const int i = __builtin_ctzll(active);
    const std::uint64_t below = (std::uint64_t{1} << i) - 1;
    active &= active - 1;
    std::uint32_t lanes[16];
    for (int row = 0; row < 8; ++row) {
      lanes[row] = base[row] + static_cast<std::uint32_t>(__builtin_popcountll(bits[row] & below));
      lanes[row + 8] = lanes[row] + static_cast<std::uint32_t>((bits[row] >> i) & 1);
    }
    unsigned solid_corners = 0;
    for (int row = 0; row < 4; ++row)
      solid_corners |= static_cast<unsigned>(((r[row]->solid >> i) & 1) | (((r[row]->next >> i) & 1) << 1))
                       << (2 * row);
    const LaneCase& c = lane_cases()[solid_corners];
    for (int e = 0; e < c.indices; ++e) out[e] = lanes[c.lanes[e]];
    out += c.indices;
  }
  return out;
}

std::size_t triangles_kernel(const RowWord* lower, const RowWord* upper, const std::uint64_t* cells, int rows,
                             int words, std::uint32_t* out, std::uint64_t& cut) {
  std::uint32_t* const begin = out;
  for (int at = 0; at < rows * words; ++at) {
    const RowWord* r[4] = {lower + at, lower + at + words, upper + at, upper + at + words};
    const std::uint64_t active = cut_cells(r, cells[at]);
    if (!active) continue;
    cut += static_cast<std::uint64_t>(__builtin_popcountll(active));
    out = cells_of_word(r, active, out);
  }
  return static_cast<std::size_t>(out - begin);
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::mesh::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "tafoni/mesh/impl/cases.h"

namespace tafoni::mesh::impl {

HWY_EXPORT(signs_kernel);
HWY_EXPORT(place_kernel);
HWY_EXPORT(triangles_kernel);

const LaneCase* lane_cases() {
  static const auto table = [] {
    // By edge: the lane of the row it belongs to, plus 8 for the far column.
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

void signs(const float* f, int samples, std::uint64_t* words) {
  HWY_DYNAMIC_DISPATCH(signs_kernel)(f, samples, words);
}

void place(const Plane& plane, const EdgeKey* keys, std::size_t n, float* positions, double* points,
           float* normals) {
  HWY_DYNAMIC_DISPATCH(place_kernel)(plane, keys, n, positions, points, normals);
}

std::size_t triangles(const RowWord* lower, const RowWord* upper, const std::uint64_t* cells, int rows,
                      int words, std::uint32_t* out, std::uint64_t& cut) {
  static const bool by_lanes = has_lane_popcount();
  if (by_lanes) return triangles_by_lanes(lower, upper, cells, rows, words, out, cut);
  return HWY_DYNAMIC_DISPATCH(triangles_kernel)(lower, upper, cells, rows, words, out, cut);
}

}  // namespace tafoni::mesh::impl
#endif
