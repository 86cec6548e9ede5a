// The erode operator: a function that takes off material where a control says so and the rock is soft,
// blended with what is eroded.

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/field/impl/nested.h"
#include "tafoni/field/operator.h"
#include "tafoni/field/tree.h"

namespace tafoni::field {
namespace {

/// -depth * control * (1 - resistance)
class Erosion final : public Function, public impl::HidesTrees {
 public:
  Erosion(FunctionPtr control, FunctionPtr resistance, float depth)
      : control_(std::move(control)), resistance_(std::move(resistance)), depth_(depth) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    Live live;
    for (std::size_t i = 0; i < points.size(); i += batch) {
      const std::size_t n = std::min(batch, points.size() - i);
      find_live(points.subspan(i, n), live);
      std::fill_n(out.data() + i, n, 0.f);
      for (std::size_t l = 0; l < live.count; ++l)
        out[i + live.index[l]] = amount(live.control[l], live.resistance[l]);
    }
  }

  void gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const override {
    Live live;
    Vec3f dc[batch], dr[batch];
    for (std::size_t i = 0; i < points.size(); i += batch) {
      const std::size_t n = std::min(batch, points.size() - i);
      find_live(points.subspan(i, n), live);
      std::fill_n(out.data() + i, n, Vec3f{});
      const std::span<const Vec3d> at(live.points, live.count);
      std::fill_n(dc, live.count, Vec3f{});
      if (control_) control_->gradients(at, {dc, live.count});
      std::fill_n(dr, live.count, Vec3f{});
      if (resistance_) resistance_->gradients(at, {dr, live.count});
      for (std::size_t l = 0; l < live.count; ++l)
        out[i + live.index[l]] =
            dr[l] * (depth_ * live.control[l]) - dc[l] * (depth_ * (1 - live.resistance[l]));
    }
  }

  Interval range(const Box3d& box) const override {
    const Interval c = control_ ? control_->range(box) : Interval{1, 1};
    if (c.lo == 0 && c.hi == 0) return {0, 0};
    const Interval r = resistance_ ? resistance_->range(box) : Interval{even, even};
    const float ends[] = {amount(c.lo, r.lo), amount(c.lo, r.hi), amount(c.hi, r.lo), amount(c.hi, r.hi)};
    return {*std::min_element(ends, ends + 4), *std::max_element(ends, ends + 4)};
  }
  Box3d support() const override { return control_ ? control_->support() : Box3d::everything(); }
  int depth() const override {
    return std::max(impl::depth_of(control_.get()), impl::depth_of(resistance_.get()));
  }

 private:
  static constexpr std::size_t batch = 128;  ///< points at a time, in arrays that fit the stack and the cache
  static constexpr float even = 0.5f;        ///< the resistance where no geology is given
  /// The points where the control is not 0.
  struct Live {
    Vec3d points[batch];
    float control[batch], resistance[batch];
    std::size_t index[batch], count;
  };
  float amount(float control, float resistance) const { return -(depth_ * control) * (1 - resistance); }

  void find_live(std::span<const Vec3d> points, Live& live) const {
    if (control_)
      control_->values(points, {live.control, points.size()});
    else
      std::fill_n(live.control, points.size(), 1.f);
    live.count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (live.control[i] == 0) continue;
      live.points[live.count] = points[i];
      live.control[live.count] = live.control[i];
      live.index[live.count++] = i;
    }
    if (resistance_)
      resistance_->values({live.points, live.count}, {live.resistance, live.count});
    else
      std::fill_n(live.resistance, live.count, even);
  }

  FunctionPtr control_, resistance_;
  float depth_;
};

}  // namespace

NodePtr erode(NodePtr below, FunctionPtr control, FunctionPtr resistance, double depth) {
  if (!(depth >= 0) || !std::isfinite(depth))
    fail(ErrorKind::usage, "the depth of erosion must be a length in metres, not {}", depth);
  if (depth == 0) return below;
  return blend(
      {std::move(below), function(std::make_shared<Erosion>(std::move(control), std::move(resistance),
                                                            static_cast<float>(depth)))});
}

namespace operator_erode {
const OperatorType& declaration() {
  struct Params {
    double depth = 2;
  };
  static const OperatorType type{
      .about = {.name = "erode",
                .doc = "Takes off material where a control field says so, the more the softer the rock",
                .source = "[Paris19 §5.3]",
                .params = ParamTable<Params>().real("depth", &Params::depth, "m", 0, 1e4,
                                                    "How much is taken off where the control is 1 and the "
                                                    "resistance 0; 0 leaves the tree as it is")},
  };
  return type;
}
}  // namespace operator_erode

}  // namespace tafoni::field
