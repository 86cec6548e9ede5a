#include "tafoni/field/impl/operator_entry.h"

#if TAFONI_KERNELS  // the values, once for every instruction set

struct Difference {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return min(a, -b);
  }
};

#else

namespace tafoni::field {

namespace operator_difference {
const OperatorType& declaration() {
  static const OperatorType type{
      .about = {.name = "difference",
                .doc = "The first operand without the solid of the second: min(a, -b)",
                .source = "[Paris19 §5.3]"},
      .combination = {{
          .interval =
              [](Interval a, Interval b, float) {
                return Interval{std::min(a.lo, -b.hi), std::min(a.hi, -b.lo)};
              },
          .needs = [](Interval a, Interval b, float) { return a.hi < -b.hi ? Needs::first : Needs::both; },
          .kernels = &impl::difference_kernels,
      }},
  };
  return type;
}
}  // namespace operator_difference

}  // namespace tafoni::field

#endif
