#include "tafoni/field/operator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/operators/difference.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/operator-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Difference {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return min(a, -b);
  }
};
OperatorKernels difference_kernels() {
  return make_operator<Difference>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(OperatorKernels, difference)

const OperatorType& operator_difference() {
  static const OperatorType type{
      .about = {.name = "difference",
                .doc = "The first operand without the solid of the second: min(a, -b)",
                .source = "[Paris19 §5.3]"},
      .interval =
          [](Interval a, Interval b, float) {
            return Interval{std::min(a.lo, -b.hi), std::min(a.hi, -b.lo)};
          },
      .needs = [](Interval a, Interval b, float) { return a.hi < -b.hi ? Needs::first : Needs::both; },
      .kernels = &kernels,
  };
  return type;
}

}  // namespace tafoni::field
#endif
