#include "tafoni/field/impl/operator_entry.h"

#if TAFONI_KERNELS  // the values, once for every instruction set

struct Blend {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return a + b;
  }
};

#else

namespace tafoni::field {

namespace operator_blend {
const OperatorType& declaration() {
  static const OperatorType type{
      .about = {.name = "blend", .doc = "Sum of the operands", .source = "[Paris19 §5.3]"},
      .combination = {{
          .interval = [](Interval a, Interval b, float) { return a + b; },
          .needs =
              [](Interval a, Interval b, float) {
                return a.lo == 0 && a.hi == 0   ? Needs::second
                       : b.lo == 0 && b.hi == 0 ? Needs::first
                                                : Needs::both;
              },
          .kernels = &impl::blend_kernels,
      }},
  };
  return type;
}
}  // namespace operator_blend

}  // namespace tafoni::field

#endif
