#include "tafoni/field/impl/operator_entry.h"

#if TAFONI_KERNELS  // the values, once for every instruction set

struct Union {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return max(a, b);
  }
};

#else

namespace tafoni::field {

namespace operator_union {
const OperatorType& declaration() {
  static const OperatorType type{
      .about = {.name = "union",
                .doc = "Solid where any operand is: the greatest value",
                .source = "[Paris19 §5.3]"},
      .combination = {{
          .interval =
              [](Interval a, Interval b, float) {
                return Interval{std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
              },
          .needs =
              [](Interval a, Interval b, float) {
                return a.lo > b.hi ? Needs::first : b.lo > a.hi ? Needs::second : Needs::both;
              },
          .kernels = &impl::union_kernels,
      }},
  };
  return type;
}
}  // namespace operator_union

}  // namespace tafoni::field

#endif
