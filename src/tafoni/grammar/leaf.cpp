#include "tafoni/grammar/leaf.h"

#include "tafoni/field/each_point.h"
#include "tafoni/field/function.h"
#include "tafoni/math/lattice.h"

namespace tafoni::grammar {
namespace {

class Placed final : public field::Function {
 public:
  Placed(SolidPtr solid, const Pose& pose) : solid_(std::move(solid)), pose_(pose) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field::each_point(points, out, [this](Vec3d p) { return solid_->distance(pose_.own(p)); });
  }
  // A true distance changes by no more than the way that is gone.
  Interval range(const Box3d& box) const override {
    const double middle = solid_->distance(pose_.own(box.center())), way = length(box.size()) / 2;
    const double rounding = 1e-6 * (std::abs(middle) + way);
    return rounded(middle - way - rounding, middle + way + rounding);
  }
  double step() const override { return 1e-3; }

 private:
  SolidPtr solid_;
  Pose pose_;
};

}  // namespace

field::FunctionPtr as_function(SolidPtr solid, const Pose& pose) {
  return std::make_shared<Placed>(std::move(solid), pose);
}

field::NodePtr leaf(SolidPtr solid, const Pose& pose) {
  return field::function(as_function(std::move(solid), pose));
}

}  // namespace tafoni::grammar
