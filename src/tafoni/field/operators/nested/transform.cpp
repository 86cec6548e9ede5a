// The transform operator: the tree is asked at positions seen from where it stands, and answers in its own
// scale.

#include "tafoni/field/impl/node.h"
#include "tafoni/field/impl/points.h"
#include "tafoni/field/impl/pose.h"
#include "tafoni/field/operator.h"

namespace tafoni::field {
namespace {

using impl::PointWork;
using impl::Pose;
using impl::Program;

class Transformed final : public impl::Nested {
 public:
  Transformed(std::shared_ptr<const Program> child, const Placement& placement)
      : child_(std::move(child)), pose_(placement), scale_(static_cast<float>(placement.scale)) {}

  void values(std::span<const Vec3d> points, PointWork& work, float* out) const override {
    work.values(*child_, own(points, work), out);
    for (std::size_t i = 0; i < points.size(); ++i) out[i] *= scale_;
  }
  void gradients(std::span<const Vec3d> points, PointWork& work, impl::PointValues* out) const override {
    work.gradients(*child_, own(points, work), out);
    for (std::size_t i = 0; i < points.size(); ++i) {
      impl::PointValues& f = out[i / 8];
      const std::size_t l = i % 8;
      f.v[l] *= scale_;
      const Vec3f g = to_float(pose_.turn(to_double(Vec3f{f.gx[l], f.gy[l], f.gz[l]})));
      f.gx[l] = g.x, f.gy[l] = g.y, f.gz[l] = g.z;
    }
  }
  Interval range(const Box3d& box, PointWork& work) const override {
    const Interval r = work.range(*child_, pose_.own_box(box));
    return {r.lo * scale_, r.hi * scale_};
  }
  Interval extent(const Box3d& column, PointWork& work) const override {
    // A column stays one only while it stands upright.
    if (pose_.sin_tilt != 0) return impl::no_extent;
    const Interval own = work.extent(*child_, pose_.own_box(column));
    if (own.lo > own.hi) return own;
    const auto to_world = [&](float z) { return static_cast<float>(pose_.to_world({0, 0, z}).z); };
    return {to_world(own.lo), to_world(own.hi)};
  }
  Box3d bounds() const override { return pose_.world_box(impl::bounds(*child_)); }
  float reach() const override { return child_->reach * scale_; }

 private:
  std::span<const Vec3d> own(std::span<const Vec3d> points, PointWork& work) const {
    auto& own = work.scratch.points;
    own.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) own[i] = pose_.to_own(points[i]);
    return own;
  }

  std::shared_ptr<const Program> child_;
  Pose pose_;
  float scale_;
};

class TransformNode final : public impl::NestedNode {
 public:
  TransformNode(NodePtr child, const Placement& placement)
      : child_(std::move(child)), placement_(placement) {}
  std::shared_ptr<const impl::Nested> compile(impl::Compiler& compiler) const override {
    return std::make_shared<Transformed>(compiler.program(child_), placement_);
  }
  NodePtr child() const override { return child_; }
  Box3d support(const Box3d& child) const override { return Pose(placement_).world_box(child); }
  void each_pose(const std::function<void(const Pose*)>& visit) const override {
    const Pose pose(placement_);
    visit(&pose);
  }
  std::uint64_t bytes() const override { return sizeof(*this); }

 private:
  NodePtr child_;
  Placement placement_;
};

}  // namespace

NodePtr transform(NodePtr tree, const Placement& placement) {
  impl::check(placement);
  return impl::make_nested(std::make_unique<TransformNode>(std::move(tree), placement));
}

namespace operator_transform {
const OperatorType& declaration() {
  static const OperatorType type{
      .about = {.name = "transform",
                .doc = "A tree moved, turned and scaled; lengths and field values alike, so that the field "
                       "stays in metres",
                .source = "[Paris19 §8.3]",
                .params = impl::placement_params()},
  };
  return type;
}
}  // namespace operator_transform

}  // namespace tafoni::field
