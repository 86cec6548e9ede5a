// Every kernel of an operator, from one template over Lanes and Dual. See math/lanes-inl.h for the toggle.
#if defined(TAFONI_FIELD_IMPL_OPERATOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TAFONI_FIELD_IMPL_OPERATOR_INL_H_
#undef TAFONI_FIELD_IMPL_OPERATOR_INL_H_
#else
#define TAFONI_FIELD_IMPL_OPERATOR_INL_H_
#endif

#include "tafoni/field/impl/kernels.h"
#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

template <class Op>
void operator_block(const Block& a, const Block& b) {
  for (int k = 0; k < a.nz; ++k)
    for (int j = 0; j < a.ny; ++j)
      for (std::size_t l = 0; l < 8; l += lane_count()) {
        float* fa = a.f + k * a.plane + j * a.row + l;
        const float* fb = b.f + k * b.plane + j * b.row + l;
        Op::apply(Lanes::load(fa), Lanes::load(fb)).store(fa);
      }
}

template <class Op>
void operator_points(float* a, const float* b) {
  for (std::size_t l = 0; l < 8; l += lane_count())
    Op::apply(Lanes::load(a + l), Lanes::load(b + l)).store(a + l);
}

TAFONI_LANES_INLINE Dual load_dual(const PointValues& p, std::size_t l) {
  return {Lanes::load(p.v + l), Lanes::load(p.gx + l), Lanes::load(p.gy + l), Lanes::load(p.gz + l)};
}

template <class Op>
void operator_gradients(PointValues& a, const PointValues& b) {
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    const Dual r = Op::apply(load_dual(a, l), load_dual(b, l));
    r.v.store(a.v + l);
    r.x.store(a.gx + l);
    r.y.store(a.gy + l);
    r.z.store(a.gz + l);
  }
}

template <class Op>
OperatorKernels make_operator() {
  return {&operator_block<Op>, &operator_points<Op>, &operator_gradients<Op>};
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#endif
