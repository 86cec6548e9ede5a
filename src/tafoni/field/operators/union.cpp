#include "tafoni/field/operator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/operators/union.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/operator-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Union {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return max(a, b);
  }
};
OperatorKernels union_kernels() {
  return make_operator<Union>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(OperatorKernels, union)

const OperatorType& operator_union() {
  static const OperatorType type{
      .about = {.name = "union",
                .doc = "Solid where any operand is: the greatest value",
                .source = "[Paris19 §5.3]"},
      .interval =
          [](Interval a, Interval b, float) {
            return Interval{std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
          },
      .needs = [](Interval a, Interval b,
                  float) { return a.lo > b.hi   ? Needs::first
                                  : b.lo > a.hi ? Needs::second
                                                : Needs::both; },
      .kernels = &kernels,
  };
  return type;
}

}  // namespace tafoni::field
#endif
