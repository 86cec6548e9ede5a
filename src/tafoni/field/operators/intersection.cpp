#include "tafoni/field/operator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/operators/intersection.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/operator-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Intersection {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return min(a, b);
  }
};
OperatorKernels intersection_kernels() {
  return make_operator<Intersection>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(OperatorKernels, intersection)

const OperatorType& operator_intersection() {
  static const OperatorType type{
      .about = {.name = "intersection",
                .doc = "Solid where all operands are: the least value",
                .source = "[Paris19 §5.3]"},
      .interval =
          [](Interval a, Interval b, float) {
            return Interval{std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
          },
      .needs = [](Interval a, Interval b,
                  float) { return a.hi < b.lo   ? Needs::first
                                  : b.hi < a.lo ? Needs::second
                                                : Needs::both; },
      .kernels = &kernels,
  };
  return type;
}

}  // namespace tafoni::field
#endif
