#include "tafoni/field/impl/operator_entry.h"

#if TAFONI_KERNELS  // the values, once for every instruction set

struct Morph {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b, const N& alpha) {
    return a * (N(1.f) - alpha) + b * alpha;
  }
};

#else

namespace tafoni::field {

namespace operator_morph {
const OperatorType& declaration() {
  struct Params {
    double alpha = 0.5;
  };
  static const OperatorType type{
      .about = {.name = "morph",
                .doc = "From the first operand to the second: a (1 - alpha) + b alpha",
                .source = "[Zawadzki]",
                .params = ParamTable<Params>().real("alpha", &Params::alpha, "", 0, 1,
                                                    "0 is the first operand, 1 the second")},
      .combination = {{
          .interval =
              [](Interval a, Interval b, float alpha) {
                const float rest = 1 - alpha;
                return Interval{a.lo * rest + b.lo * alpha, a.hi * rest + b.hi * alpha};
              },
          .needs = [](Interval, Interval, float) { return Needs::both; },
          .kernels = &impl::morph_kernels,
      }},
  };
  return type;
}
}  // namespace operator_morph

}  // namespace tafoni::field

#endif
