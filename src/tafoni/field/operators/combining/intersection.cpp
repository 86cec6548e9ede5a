#include "tafoni/field/impl/operator_entry.h"

#if TAFONI_KERNELS  // the values, once for every instruction set

struct Intersection {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b) {
    return min(a, b);
  }
};

#else

namespace tafoni::field {

namespace operator_intersection {
const OperatorType& declaration() {
  static const OperatorType type{
      .about = {.name = "intersection",
                .doc = "Solid where all operands are: the least value",
                .source = "[Paris19 §5.3]"},
      .combination = {{
          .interval =
              [](Interval a, Interval b, float) {
                return Interval{std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
              },
          .needs =
              [](Interval a, Interval b, float) {
                return a.hi < b.lo ? Needs::first : b.hi < a.lo ? Needs::second : Needs::both;
              },
          .kernels = &impl::intersection_kernels,
      }},
  };
  return type;
}
}  // namespace operator_intersection

}  // namespace tafoni::field

#endif
