// One level of midpoint subdivision over SIMD lanes: the coarse samples that a box reads are copied into
// a patch, continued straight beyond the border, and interpolated plane by plane, row by row, sample by
// sample, by four points; noise is hashed from the seed, the level and the place.

#include "tafoni/volume/impl/subdivision.h"

#include <algorithm>
#include <vector>

#include <hwy/highway.h>

#include "tafoni/core/random.h"
#include "tafoni/math/simd.h"

#ifndef TAFONI_VOLUME_SUBDIVISION_ONCE
#define TAFONI_VOLUME_SUBDIVISION_ONCE
namespace tafoni::volume::impl {

/// One row of the fine lattice.
struct FineRow {
  std::uint32_t first;  ///< global x of its first sample, even
  std::size_t count;
  std::uint32_t key[2];
  float noise, limit;
  bool all_new;  ///< else its even samples are kept as they are
};

}  // namespace tafoni::volume::impl
#endif

HWY_BEFORE_NAMESPACE();
namespace tafoni::volume::impl {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Words = hn::RebindToUnsigned<Floats>;
using Signed = hn::RebindToSigned<Floats>;
using Vec = hn::Vec<Floats>;

HWY_INLINE Vec middle(Vec a, Vec b, Vec c, Vec d) {
  const Floats f;
  // There is no fused multiply-add here, so that every machine gives the same bits.
  const Vec sum = hn::Sub(hn::Mul(hn::Set(f, 9.0f), hn::Add(b, c)), hn::Add(a, d));
  return hn::Mul(sum, hn::Set(f, 0.0625f));
}

/// Uniform in [-1, 1) times `scale` * 2^31, by the sample's place in its row.
HWY_INLINE Vec noise_at(hn::Vec<Words> x, const FineRow& row, Vec scale) {
  const Words w;
  auto h = hn::Add(hn::Mul(x, hn::Set(w, 0x9e3779b1u)), hn::Set(w, row.key[0]));
  h = hn::Xor(h, hn::ShiftRight<16>(h));
  h = hn::Mul(h, hn::Set(w, 0x7feb352du));
  h = hn::Xor(hn::Xor(h, hn::ShiftRight<15>(h)), hn::Set(w, row.key[1]));
  h = hn::Mul(h, hn::Set(w, 0x846ca68bu));
  h = hn::Xor(h, hn::ShiftRight<16>(h));
  return hn::Mul(hn::ConvertTo(Floats(), hn::BitCast(Signed(), h)), scale);
}

/// out[i] in the middle of the four rows.
void middle_rows(const float* a, const float* b, const float* c, const float* d, std::size_t n, float* out) {
  const Floats f;
  const std::size_t lanes = hn::Lanes(f);
  for (std::size_t i = 0; i < n; i += lanes)
    hn::StoreU(middle(hn::LoadU(f, a + i), hn::LoadU(f, b + i), hn::LoadU(f, c + i), hn::LoadU(f, d + i)), f,
               out + i);
}

/// `coarse` begins one sample before row.first / 2.
template <bool noisy>
void fine_row(const float* coarse, const FineRow& row, float* out) {
  const Floats f;
  const Words w;
  const std::size_t lanes = hn::Lanes(f);
  const Vec top = hn::Set(f, row.limit), bottom = hn::Set(f, -row.limit);
  const Vec scale = hn::Set(f, row.noise * 0x1p-31f);
  const Vec even_scale = row.all_new ? scale : hn::Zero(f);
  auto x = hn::Add(hn::Set(w, row.first), hn::Mul(hn::Iota(w, 0), hn::Set(w, 2)));
  HWY_ALIGN float tail[2 * HWY_MAX_BYTES / sizeof(float)];
  for (std::size_t i = 0; i < row.count; i += 2 * lanes, coarse += lanes) {
    const Vec b = hn::LoadU(f, coarse + 1);
    Vec even = b;
    Vec odd = middle(hn::LoadU(f, coarse), b, hn::LoadU(f, coarse + 2), hn::LoadU(f, coarse + 3));
    if constexpr (noisy) {
      even = hn::Add(even, noise_at(x, row, even_scale));
      odd = hn::Add(odd, noise_at(hn::Add(x, hn::Set(w, 1)), row, scale));
      x = hn::Add(x, hn::Set(w, static_cast<std::uint32_t>(2 * lanes)));
    }
    even = hn::Min(hn::Max(even, bottom), top);
    odd = hn::Min(hn::Max(odd, bottom), top);
    if (i + 2 * lanes <= row.count) {
      hn::StoreInterleaved2(even, odd, f, out + i);
    } else {
      hn::StoreInterleaved2(even, odd, f, tail);
      std::copy_n(tail, row.count - i, out + i);
    }
  }
}

void fine_row_any(const float* coarse, const FineRow& row, float* out) {
  if (row.noise > 0)
    fine_row<true>(coarse, row, out);
  else
    fine_row<false>(coarse, row, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::volume::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::volume::impl {
namespace {

HWY_EXPORT(middle_rows);
HWY_EXPORT(fine_row_any);

/// Vectors may read and write as much beyond the end of a row: two of the widest.
constexpr std::size_t slack = 64;

/// The coarse samples that a box of fine ones reads, continued straight beyond the border of the lattice.
class Patch {
 public:
  Patch(const Lattice& coarse, const SampleBox& box, std::vector<float>& memory) : memory_(memory) {
    lo_ = {first(box.lo.x), first(box.lo.y), first(box.lo.z)};
    size_ = {last(box.hi.x) - lo_.x + 1, last(box.hi.y) - lo_.y + 1, last(box.hi.z) - lo_.z + 1};
    row_ = size_.x;
    memory_.resize(row_ * (size_.y * size_.z) + slack);
    const Range ix = inside(lo_.x, size_.x, coarse.size.x), iy = inside(lo_.y, size_.y, coarse.size.y),
                iz = inside(lo_.z, size_.z, coarse.size.z);
    for (int z = iz.from; z < iz.to; ++z) {
      for (int y = iy.from; y < iy.to; ++y) {
        const std::size_t at = (std::int64_t{lo_.z + z} * coarse.size.y + lo_.y + y) * coarse.size.x;
        float* out = row(y, z);
        std::copy_n(coarse.values + at + lo_.x + ix.from, ix.to - ix.from, out + ix.from);
        extend(ix, size_.x, [&](int to, int near, int far) { out[to] = 2 * out[near] - out[far]; });
      }
      extend(iy, size_.y,
             [&](int to, int near, int far) { go_on(row(to, z), row(near, z), row(far, z), row_); });
    }
    const std::size_t plane = row_ * size_.y;
    extend(iz, size_.z,
           [&](int to, int near, int far) { go_on(row(0, to), row(0, near), row(0, far), plane); });
  }

  /// Rows are counted from the first sample of the patch.
  float* row(int y, int z) const { return memory_.data() + row_ * (z * size_.y + y); }
  Vec3i lo() const { return lo_; }
  Vec3i size() const { return size_; }
  std::size_t row_floats() const { return row_; }

 private:
  struct Range {
    int from, to;
  };
  static int first(int fine) { return fine / 2 - 1; }
  static int last(int fine) { return (fine + 1) / 2 + 1; }
  static Range inside(int lo, int size, int lattice) {
    return {std::max(0, -lo), std::min(size, lattice - lo)};
  }
  /// Makes the one sample on each side that lies outside of the lattice from the two nearest.
  template <class Set>
  static void extend(Range in, int size, const Set& set) {
    if (in.from > 0) set(in.from - 1, in.from, in.from + 1);
    if (in.to < size) set(in.to, in.to - 1, in.to - 2);
  }
  static void go_on(float* out, const float* near, const float* far, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = 2 * near[i] - far[i];
  }

  std::vector<float>& memory_;
  Vec3i lo_, size_;
  std::size_t row_;
};

/// A thread's memory.
struct Scratch {
  std::vector<float> patch, plane, row;
};
Scratch& scratch() {
  thread_local Scratch memory;
  return memory;
}

}  // namespace

void subdivide(const Subdivision& step, const SampleBox& box, float* out, std::size_t row,
               std::size_t plane) {
  limit_simd();
  const auto middle = HWY_DYNAMIC_DISPATCH(middle_rows);
  const auto fine = HWY_DYNAMIC_DISPATCH(fine_row_any);
  Scratch& memory = scratch();
  // Rows begin at an even sample.
  SampleBox even = box;
  even.lo.x &= ~1;
  const Patch patch(step.coarse, even, memory.patch);
  const std::size_t width = patch.row_floats();
  const Vec3i size = box.size();
  const std::size_t skip = box.lo.x - even.lo.x;
  memory.plane.resize(width * patch.size().y + slack);
  memory.row.resize(width + size.x + 1 + 2 * slack);
  float* between = memory.row.data();
  float* shifted = between + width + slack;
  FineRow fine_row{static_cast<std::uint32_t>(even.lo.x), size.x + skip, {}, step.noise, step.limit, false};
  for (int k = 0; k < size.z; ++k) {
    const int z = box.lo.z + k, cz = z / 2 - patch.lo().z;
    const float* rows = patch.row(0, cz);
    if (z & 1) {
      middle(patch.row(0, cz - 1), rows, patch.row(0, cz + 1), patch.row(0, cz + 2), width * patch.size().y,
             memory.plane.data());
      rows = memory.plane.data();
    }
    for (int j = 0; j < size.y; ++j) {
      const int y = box.lo.y + j;
      const float* from = rows + width * (y / 2 - patch.lo().y);
      if (y & 1) {
        middle(from - width, from, from + width, from + 2 * width, width, between);
        from = between;
      }
      const std::uint64_t key = mix64(step.key ^ mix64((std::int64_t{z} << 32) | y));
      fine_row.key[0] = static_cast<std::uint32_t>(key);
      fine_row.key[1] = static_cast<std::uint32_t>(key >> 32);
      fine_row.all_new = ((y | z) & 1) != 0;
      float* to = out + k * plane + j * row;
      if (skip == 0) {
        fine(from, fine_row, to);
      } else {
        fine(from, fine_row, shifted);
        std::copy_n(shifted + 1, size.x, to);
      }
    }
  }
}

Interval subdivision_range(const Subdivision& step, const SampleBox& box) {
  const Patch patch(step.coarse, box, scratch().patch);
  float lo = *patch.row(0, 0), hi = lo;
  for (int z = 0; z < patch.size().z; ++z)
    for (int y = 0; y < patch.size().y; ++y) {
      const float* row = patch.row(y, z);
      for (int x = 0; x < patch.size().x; ++x) lo = std::min(lo, row[x]), hi = std::max(hi, row[x]);
    }
  // Four points overshoot by an eighth of their range to each side, along three axes: 1.25^3 in all.
  const float over = 0.4766f * (hi - lo) + step.noise + 1e-5f * std::max(std::abs(lo), std::abs(hi));
  return {lo - over, hi + over};
}

}  // namespace tafoni::volume::impl
#endif
