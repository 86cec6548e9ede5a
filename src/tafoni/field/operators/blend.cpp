#include "tafoni/field/operator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/operators/blend.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/operator-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Blend {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return a + b;
  }
};
OperatorKernels blend_kernels() {
  return make_operator<Blend>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(OperatorKernels, blend)

const OperatorType& operator_blend() {
  static const OperatorType type{
      .about = {.name = "blend", .doc = "Sum of the operands", .source = "[Paris19 §5.3]"},
      .interval = [](Interval a, Interval b, float) { return a + b; },
      .needs =
          [](Interval a, Interval b, float) {
            return a.lo == 0 && a.hi == 0   ? Needs::second
                   : b.lo == 0 && b.hi == 0 ? Needs::first
                                            : Needs::both;
          },
      .kernels = &kernels,
  };
  return type;
}

}  // namespace tafoni::field
#endif
