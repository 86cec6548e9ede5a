// The kernels of a cloud's index: a block's plain primitives are decoded and kept where their support may
// touch a box, a vector of them at a time.

#include "tafoni/field/impl/cloud.h"
#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

/// How far a coordinate lies outside of [lo, hi], metres.
TAFONI_LANES_INLINE Lanes gap(float lo, float hi, Ints at) {
  const Lanes c = to_lanes(at) * Lanes(static_cast<float>(unit));
  return max(max(Lanes(lo) - c, c - Lanes(hi)), Lanes(0.f));
}
TAFONI_LANES_INLINE Mask touches(const Box3f& box, Ints x, Ints y, Ints z, Lanes reach) {
  const Lanes dx = gap(box.lo.x, box.hi.x, x), dy = gap(box.lo.y, box.hi.y, y),
              dz = gap(box.lo.z, box.hi.z, z), far = reach + Lanes(position_slack);
  return dx * dx + dy * dy + dz * dz <= far * far;
}

std::size_t narrow(const Primitives& p, const Box3f& box, std::uint32_t* out) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < p.size(); i += lane_count()) {
    Mask hit = touches(box, Ints::load(p.x.data() + i), Ints::load(p.y.data() + i),
                       Ints::load(p.z.data() + i), Lanes::load(p.reach.data() + i));
    if (p.size() - i < lane_count()) hit = hn::And(hit, hn::FirstN(float_tag, p.size() - i));
    const hn::RebindToUnsigned<IntTag> index_tag;
    const auto index = hn::Iota(index_tag, static_cast<std::uint32_t>(i));
    n += hn::CompressStore(index, hn::RebindMask(index_tag, hit), index_tag, out + n);
  }
  return n;
}

void decode(const PackedRange& range, const Box3f& box, Primitives& out) {
  constexpr std::size_t most = 8;  // lanes of the widest vectors
  out.reserve(range.count + most);
  const Packed& p = *range.packed;
  for (std::size_t i = 0; i < range.count; i += lane_count()) {
    const std::size_t at = range.first + i, left = range.count - i;
    alignas(32) std::int32_t lo[most] = {}, hi[most] = {};
    alignas(32) float radius[most] = {}, energy[most] = {};
    Ints a, b;
    Lanes r, e;
    if (left >= lane_count()) {
      a = hn::BitCast(int_tag, hn::LoadU(hn::RebindToUnsigned<IntTag>(), p.lo.data() + at));
      b = hn::BitCast(int_tag, hn::LoadU(hn::RebindToUnsigned<IntTag>(), p.hi.data() + at));
      r = Lanes::load(p.radius.data() + at);
      e = Lanes::load(p.energy.data() + at);
    } else {
      std::copy_n(p.lo.data() + at, left, reinterpret_cast<std::uint32_t*>(lo));
      std::copy_n(p.hi.data() + at, left, reinterpret_cast<std::uint32_t*>(hi));
      std::copy_n(p.radius.data() + at, left, radius);
      std::copy_n(p.energy.data() + at, left, energy);
      a = Ints::load(lo), b = Ints::load(hi), r = Lanes::load(radius), e = Lanes::load(energy);
    }
    const Ints x = (a & Ints(0x1fffff)) + Ints(range.cell.x);
    const Ints y = (shift_right_unsigned<21>(a) + shift_left<11>(b & Ints(0x3ff))) + Ints(range.cell.y);
    const Ints z = shift_right_unsigned<10>(b) + Ints(range.cell.z);
    const Lanes reach = (r + Lanes(range.beyond)) * Lanes(reach_factor) + Lanes(reach_margin);
    Mask hit = touches(box, x, y, z, reach);
    if (left < lane_count()) hit = hn::And(hit, hn::FirstN(float_tag, left));
    const auto int_hit = hn::RebindMask(int_tag, hit);
    const std::size_t n = out.count;
    hn::CompressStore(x.v, int_hit, int_tag, out.x.data() + n);
    hn::CompressStore(y.v, int_hit, int_tag, out.y.data() + n);
    hn::CompressStore(z.v, int_hit, int_tag, out.z.data() + n);
    hn::CompressStore(r.v, hit, float_tag, out.radius.data() + n);
    hn::CompressStore(e.v, hit, float_tag, out.energy.data() + n);
    out.count += hn::CompressStore(reach.v, hit, float_tag, out.reach.data() + n);
  }
}

IndexKernels make_index_kernels() {
  return {&decode, &narrow};
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field::impl {

HWY_EXPORT(make_index_kernels);

const IndexKernels& index_kernels() {
  static const IndexKernels table = HWY_DYNAMIC_DISPATCH(make_index_kernels)();
  return table;
}

}  // namespace tafoni::field::impl
#endif
