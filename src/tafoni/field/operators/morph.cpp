#include "tafoni/field/operator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/field/operators/morph.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include "tafoni/core/error.h"
#include "tafoni/field/impl/kernel_table.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/impl/operator-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {

struct Morph {
  template <class N>
  static TAFONI_LANES_INLINE N apply(const N& a, const N& b, const N& alpha) {
    return a * (N(1.f) - alpha) + b * alpha;
  }
};
OperatorKernels morph_kernels() {
  return make_operator<Morph>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field {
TAFONI_KERNEL_TABLE(OperatorKernels, morph)
namespace {

struct Params {
  double alpha = 0.5;
};

}  // namespace

const OperatorType& operator_morph() {
  static const OperatorType type{
      .about = {.name = "morph",
                .doc = "From the first operand to the second: a (1 - alpha) + b alpha",
                .source = "[Zawadzki]",
                .params = ParamTable<Params>().real("alpha", &Params::alpha, "", 0, 1,
                                                    "0 is the first operand, 1 the second")},
      .interval =
          [](Interval a, Interval b, float alpha) {
            const float rest = 1 - alpha;
            return Interval{a.lo * rest + b.lo * alpha, a.hi * rest + b.hi * alpha};
          },
      .needs = [](Interval, Interval, float) { return Needs::both; },
      .kernels = &kernels,
  };
  return type;
}

NodePtr morph(NodePtr a, NodePtr b, double alpha) {
  if (!(alpha >= 0 && alpha <= 1)) fail(ErrorKind::usage, "morph: alpha = {} is outside 0 to 1", alpha);
  if (alpha == 0) return a;
  if (alpha == 1) return b;
  return std::make_shared<Node>(
      Node::Operation{&operator_morph(), {std::move(a), std::move(b)}, static_cast<float>(alpha)});
}

}  // namespace tafoni::field
#endif
