// The round operator: an intersection whose edge is worn by a quadratic smooth minimum, which reaches as far
// as the operands differ by less than the width.
#include "tafoni/field/impl/operator_entry.h"

#if TAFONI_KERNELS  // the values, once for every instruction set

struct Round {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b, const N& width) {
    const N h = max(width - max(a - b, b - a), N(0.f));
    return min(a, b) - h * h / (width * N(4.f));
  }
};

#else

namespace tafoni::field {
namespace {

/// It falls with neither operand, so that its ends are at theirs.
float at(float a, float b, float width) {
  const float h = std::max(width - std::abs(a - b), 0.f);
  return std::min(a, b) - h * h / (4 * width);
}

}  // namespace

namespace operator_round {
const OperatorType& declaration() {
  struct Params {
    double width = 1;
  };
  static const OperatorType type{
      .about = {.name = "round",
                .doc = "Solid where both operands are, with a worn edge: min(a, b) - h^2 / (4 width), h = "
                       "width - |a - b|",
                .source = "a quadratic smooth minimum",
                .params = ParamTable<Params>().real(
                    "width", &Params::width, "m", 1e-3, 1e4,
                    "Difference of the operands below which the edge is worn: more wears more of it")},
      .combination = {{
          .interval =
              [](Interval a, Interval b, float width) {
                const float lo = at(a.lo, b.lo, width), hi = at(a.hi, b.hi, width);
                constexpr float rounding = 1e-6f;  // of a few operations in float, as a part of the values
                return Interval{lo - rounding * (std::abs(lo) + width),
                                hi + rounding * (std::abs(hi) + width)};
              },
          .needs =
              [](Interval a, Interval b, float width) {
                return a.hi + width <= b.lo   ? Needs::first
                       : b.hi + width <= a.lo ? Needs::second
                                              : Needs::both;
              },
          .kernels = &impl::round_kernels,
      }},
  };
  return type;
}
}  // namespace operator_round

}  // namespace tafoni::field

#endif
