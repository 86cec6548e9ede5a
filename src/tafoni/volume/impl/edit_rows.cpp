#include "tafoni/volume/impl/edit_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tafoni/volume/impl/edit_rows.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include <hwy/highway.h>

#include "tafoni/math/simd.h"
#include "tafoni/volume/scalar_grid.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::volume::impl {
namespace HWY_NAMESPACE {

// Plain loops, which the compiler turns into vectors of the instruction set it compiles for. No sums are
// fused, so that all give the same bits.
void distances(const Sphere& ball, double amplitude, const SampleRun& run, double* out) {
  const double y = run.y - ball.center.y, z = run.z - ball.center.z, x0 = ball.center.x;
  const double yy = y * y, zz = z * z, radius = ball.radius, origin = run.origin, spacing = run.spacing;
  const int first = run.first, n = run.n;
  for (int i = 0; i < n; ++i) {
    const double x = origin + spacing * (first + i) - x0;
    const double d = radius - std::sqrt(x * x + yy + zz);
    out[i] = d < amplitude ? d : amplitude;
  }
}

void combine_kernel(const Sphere& ball, Edit edit, double amplitude, const SampleRun& run, float* values) {
  double d[ScalarGrid::chunk_samples];
  distances(ball, amplitude, run, d);
  const int n = run.n;
  if (edit == Edit::add) {
    for (int i = 0; i < n; ++i) {
      const float v = values[i], own = static_cast<float>(d[i]);
      values[i] = d[i] > -amplitude && own > v ? own : v;
    }
    return;
  }
  for (int i = 0; i < n; ++i) {
    const float v = values[i], own = static_cast<float>(-d[i]);
    values[i] = d[i] > -amplitude && own < v ? own : v;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::volume::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::volume::impl {

HWY_EXPORT(combine_kernel);

void combine(const Sphere& ball, Edit edit, double amplitude, const SampleRun& run, float* values) {
  limit_simd();
  HWY_DYNAMIC_DISPATCH(combine_kernel)(ball, edit, amplitude, run, values);
}

}  // namespace tafoni::volume::impl
#endif
