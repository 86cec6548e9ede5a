#include "tafoni/landforms/rock/replacement.h"

#include <algorithm>
#include <vector>

namespace tafoni::landforms::impl {
namespace {

class Replacement final : public field::Function {
 public:
  Replacement(field::FunctionPtr old, field::FunctionPtr now, field::FunctionPtr control)
      : old_(std::move(old)), now_(std::move(now)), control_(std::move(control)) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    std::vector<float> weights(points.size());
    control_->values(points, weights);
    std::vector<Vec3d> outside, inside;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (weights[i] < 1) outside.push_back(points[i]);
      if (weights[i] > 0) inside.push_back(points[i]);
    }
    std::vector<float> before(outside.size()), after(inside.size());
    if (!outside.empty()) old_->values(outside, before);
    if (!inside.empty()) now_->values(inside, after);
    std::size_t o = 0, n = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float w = weights[i];
      const float a = w < 1 ? before[o++] : 0.0f, b = w > 0 ? after[n++] : 0.0f;
      // The mix is held between the two, so that rounding does not leave the range.
      out[i] = w <= 0 ? a : w >= 1 ? b : std::clamp(a + w * (b - a), std::min(a, b), std::max(a, b));
    }
  }
  double step() const override { return now_->step(); }
  Interval range(const Box3d& box) const override {
    const Interval w = control_->range(box);
    if (w.hi <= 0) return old_->range(box);
    const Interval b = now_->range(box);
    if (w.lo >= 1) return b;
    const Interval a = old_->range(box);
    return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
  }

 private:
  field::FunctionPtr old_, now_, control_;
};

}  // namespace

field::FunctionPtr replace_within(field::FunctionPtr old, field::FunctionPtr now,
                                  field::FunctionPtr control) {
  return std::make_shared<Replacement>(std::move(old), std::move(now), std::move(control));
}

}  // namespace tafoni::landforms::impl
