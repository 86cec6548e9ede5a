#include "tafoni/field/round.h"

#include "tafoni/field/operator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/operators/round.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/core/error.h"
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/impl/operator-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Round {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b, const N& width) {
    const N h = max(width - max(a - b, b - a), N(0.f));
    return min(a, b) - h * h / (width * N(4.f));
  }
};
OperatorKernels round_kernels() {
  return make_operator<Round>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(OperatorKernels, round)
namespace {

struct Params {
  double width = 1;
};

/// It falls with neither operand, so that its ends are at theirs.
float at(float a, float b, float width) {
  const float h = std::max(width - std::abs(a - b), 0.f);
  return std::min(a, b) - h * h / (4 * width);
}

}  // namespace

const OperatorType& operator_round() {
  static const OperatorType type{
      .about = {.name = "round",
                .doc = "Solid where both operands are, with a worn edge: min(a, b) - h^2 / (4 width), h = "
                       "width - |a - b|",
                .source = "a quadratic smooth minimum",
                .params = ParamTable<Params>().real("width", &Params::width, "m", 1e-3, 1e4,
                                                    "difference of the operands below which it acts")},
      .interval =
          [](Interval a, Interval b, float width) {
            const float lo = at(a.lo, b.lo, width), hi = at(a.hi, b.hi, width);
            constexpr float rounding = 1e-6f;
            return Interval{lo - rounding * (std::abs(lo) + width), hi + rounding * (std::abs(hi) + width)};
          },
      .needs =
          [](Interval a, Interval b, float width) {
            return a.hi + width <= b.lo ? Needs::first : b.hi + width <= a.lo ? Needs::second : Needs::both;
          },
      .kernels = &kernels,
  };
  return type;
}

NodePtr rounded(NodePtr a, NodePtr b, double width) {
  checked(operator_round().about.params.front(), width, "round");
  return std::make_shared<Node>(
      Node::Operation{&operator_round(), {std::move(a), std::move(b)}, static_cast<float>(width)});
}

}  // namespace tafoni::field
#endif
