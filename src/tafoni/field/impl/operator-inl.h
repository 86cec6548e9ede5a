// Every kernel of an operator, from one template over Lanes and Dual. See math/lanes-inl.h for the toggle.
#if defined(TAFONI_FIELD_IMPL_OPERATOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TAFONI_FIELD_IMPL_OPERATOR_INL_H_
#undef TAFONI_FIELD_IMPL_OPERATOR_INL_H_
#else
#define TAFONI_FIELD_IMPL_OPERATOR_INL_H_
#endif

#include "tafoni/field/impl/kernels.h"
#include "tafoni/field/impl/operator_entry.h"
#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

/// An operator is a struct with apply(a, b), or apply(a, b, parameter) where it has one.
template <class Op, class N>
TAFONI_LANES_INLINE N apply_to(const N& a, const N& b, float parameter) {
  if constexpr (requires { Op::apply(a, b, N(parameter)); })
    return Op::apply(a, b, N(parameter));
  else
    return Op::apply(a, b);
}

template <class Op>
void operator_block(const Block& a, const Block& b, float parameter) {
  for (int k = 0; k < a.nz; ++k)
    for (int j = 0; j < a.ny; ++j)
      for (std::size_t l = 0; l < 8; l += lane_count()) {
        float* fa = a.f + k * a.plane + j * a.row + l;
        const float* fb = b.f + k * b.plane + j * b.row + l;
        apply_to<Op>(Lanes::load(fa), Lanes::load(fb), parameter).store(fa);
      }
}

template <class Op>
void operator_points(float* a, const float* b, float parameter) {
  for (std::size_t l = 0; l < 8; l += lane_count())
    apply_to<Op>(Lanes::load(a + l), Lanes::load(b + l), parameter).store(a + l);
}

TAFONI_LANES_INLINE Dual load_dual(const PointValues& p, std::size_t l) {
  return {Lanes::load(p.v + l), Lanes::load(p.gx + l), Lanes::load(p.gy + l), Lanes::load(p.gz + l)};
}

template <class Op>
void operator_gradients(PointValues& a, const PointValues& b, float parameter) {
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    const Dual r = apply_to<Op>(load_dual(a, l), load_dual(b, l), parameter);
    r.v.store(a.v + l);
    r.x.store(a.gx + l);
    r.y.store(a.gy + l);
    r.z.store(a.gz + l);
  }
}

template <class Op>
OperatorKernels make_kernels() {
  return {&operator_block<Op>, &operator_points<Op>, &operator_gradients<Op>};
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#endif
