#include "tafoni/field/impl/cloud.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/impl/index.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

unsigned overlaps(const WideBox& w, const Box3f& box) {
  const float lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
  unsigned mask = 0;
  for (std::size_t l = 0; l < WideBox::fan; l += lane_count()) {
    Mask hit = hn::And(Lanes::load(w.lo[0] + l) <= Lanes(hi[0]), Lanes::load(w.hi[0] + l) >= Lanes(lo[0]));
    for (int a = 1; a < 3; ++a)
      hit = hn::And(
          hit, hn::And(Lanes::load(w.lo[a] + l) <= Lanes(hi[a]), Lanes::load(w.hi[a] + l) >= Lanes(lo[a])));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(float_tag, hit, bits);
    mask |= static_cast<unsigned>(bits[0]) << l;
  }
  return mask;
}

IndexKernels make_index_kernels() {
  return {&overlaps};
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
