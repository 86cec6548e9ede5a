// The instance operator: copies of one tree, stored as placements in canonical order and found by their
// boxes. Their values are summed in that order.

#include <algorithm>
#include <tuple>

#include "tafoni/core/error.h"
#include "tafoni/field/impl/box_tree.h"
#include "tafoni/field/impl/curve.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/impl/points.h"
#include "tafoni/field/impl/pose.h"
#include "tafoni/field/operator.h"

namespace tafoni::field {
namespace {

using impl::PointWork;
using impl::Pose;
using impl::Program;

/// What a ball is grown by for the rounding of its centre and radius, metres.
constexpr double ball_slack = 1e-6;

/// A placement as it is stored, 24 bytes.
struct Packed {
  Vec3i position;  ///< units
  float turn, tilt, scale;

  explicit Packed(const Placement& p)
      : position{impl::to_fixed(p.position.x).units, impl::to_fixed(p.position.y).units,
                 impl::to_fixed(p.position.z).units},
        turn(static_cast<float>(p.turn)),
        tilt(static_cast<float>(p.tilt)),
        scale(static_cast<float>(p.scale)) {}
  Vec3d metres() const {
    return {impl::to_metres(position.x), impl::to_metres(position.y), impl::to_metres(position.z)};
  }
  Pose pose() const { return Pose({metres(), turn, tilt, scale}); }
  auto key() const {
    return std::tuple(impl::curve_key(position), impl::order_key(turn), impl::order_key(tilt),
                      impl::order_key(scale));
  }
};

/// Placements in canonical order, found by their boxes.
class Placements {
 public:
  Placements(const Box3d& shape, std::span<const Placement> placements) : shape_(shape) {
    packed_.reserve(placements.size());
    for (const Placement& p : placements) {
      impl::check(p);
      packed_.emplace_back(p);
    }
    std::sort(packed_.begin(), packed_.end(),
              [](const Packed& a, const Packed& b) { return a.key() < b.key(); });
    for (int c = 0; c < 8; ++c)
      radius_ =
          std::max(radius_, length(Vec3d{c & 1 ? shape.hi.x : shape.lo.x, c & 2 ? shape.hi.y : shape.lo.y,
                                         c & 4 ? shape.hi.z : shape.lo.z}));
    std::vector<Box3f> boxes((packed_.size() + block - 1) / block);
    for (std::size_t i = 0; i < packed_.size(); ++i) {
      const Box3d box = packed_[i].pose().world_box(shape);
      const Vec3d far{std::max(std::fabs(box.lo.x), std::fabs(box.hi.x)),
                      std::max(std::fabs(box.lo.y), std::fabs(box.hi.y)),
                      std::max(std::fabs(box.lo.z), std::fabs(box.hi.z))};
      if (std::max({far.x, far.y, far.z}) > impl::reach_limit)
        fail(ErrorKind::input, "an instance lies {:.0f} m from the scene's origin; the limit is {:.0f} m",
             std::max({far.x, far.y, far.z}), impl::reach_limit);
      bounds_.expand(box);
      boxes[i / block].expand(floats(box));
    }
    tree_ = impl::BoxTree(std::move(boxes));
  }

  /// Calls visit(pose, scale), in canonical order, for each placement that may touch `box`.
  template <class Visit>
  void visit(const Box3d& box, const Visit& visit) const {
    tree_.visit(floats(box), [&](std::size_t b) {
      for (std::size_t i = b * block; i < std::min((b + 1) * block, packed_.size()); ++i) {
        const Packed& p = packed_[i];
        const Vec3d c = p.metres();
        const auto gap = [](double lo, double hi, double v) {
          return std::max(std::max(lo - v, v - hi), 0.0);
        };
        const Vec3d d{gap(box.lo.x, box.hi.x, c.x), gap(box.lo.y, box.hi.y, c.y),
                      gap(box.lo.z, box.hi.z, c.z)};
        const double reach = radius_ * p.scale + ball_slack;
        if (dot(d, d) <= reach * reach) visit(p.pose(), p.scale);
      }
    });
  }

  const Box3d& shape() const { return shape_; }
  const Box3d& bounds() const { return bounds_; }
  std::size_t size() const { return packed_.size(); }
  std::uint64_t bytes() const { return sizeof(*this) + packed_.size() * sizeof(Packed) + tree_.bytes(); }

 private:
  /// Placements that share a box in the tree, so that the tree stays small beside them.
  static constexpr std::size_t block = 4;
  static Box3f floats(const Box3d& box) {
    return Box3f{to_float(box.lo), to_float(box.hi)}.grown(impl::position_slack);
  }

  Box3d shape_;        ///< support of the placed tree, in its own frame
  double radius_ = 0;  ///< of the shape about its own origin
  Box3d bounds_;
  std::vector<Packed> packed_;
  impl::BoxTree tree_;
};

class Instanced final : public impl::Nested {
 public:
  Instanced(std::shared_ptr<const Program> child, std::shared_ptr<const Placements> placements)
      : child_(std::move(child)), placements_(std::move(placements)) {}

  void values(std::span<const Vec3d> points, PointWork& work, float* out) const override {
    std::fill_n(out, points.size(), 0.f);
    each_touched(points, work, [&](const Pose&, float scale) {
      auto& f = work.scratch.values;
      f.resize(work.scratch.points.size());
      work.values(*child_, work.scratch.points, f.data());
      for (std::size_t m = 0; m < f.size(); ++m) out[work.scratch.items[m]] += scale * f[m];
    });
  }

  void gradients(std::span<const Vec3d> points, PointWork& work, impl::PointValues* out) const override {
    std::fill_n(out, (points.size() + 7) / 8, impl::PointValues{});
    each_touched(points, work, [&](const Pose& pose, float scale) {
      auto& f = work.scratch.gradients;
      const std::size_t n = work.scratch.points.size();
      f.resize((n + 7) / 8);
      work.gradients(*child_, work.scratch.points, f.data());
      for (std::size_t m = 0; m < n; ++m) {
        const impl::PointValues& from = f[m / 8];
        const std::size_t l = m % 8, i = work.scratch.items[m];
        impl::PointValues& to = out[i / 8];
        const Vec3f g = to_float(pose.turn(to_double(Vec3f{from.gx[l], from.gy[l], from.gz[l]})));
        to.v[i % 8] += scale * from.v[l];
        to.gx[i % 8] += g.x, to.gy[i % 8] += g.y, to.gz[i % 8] += g.z;
      }
    });
  }

  Interval range(const Box3d& box, PointWork& work) const override {
    Interval sum{0, 0};
    placements_->visit(box, [&](const Pose& pose, float scale) {
      const Box3d own = pose.own_box(box), common = intersection(own, placements_->shape());
      if (common.empty()) return;
      Interval r = work.range(*child_, common);
      if (!(common.lo == own.lo && common.hi == own.hi)) r = {std::min(r.lo, 0.f), std::max(r.hi, 0.f)};
      sum = sum + Interval{r.lo * scale, r.hi * scale};
    });
    return sum;  // in the order in which values() sums, so that rounding keeps it an enclosure
  }

  Interval extent(const Box3d& column, PointWork&) const override {
    Interval z = impl::no_extent;
    Box3d tall = column;
    tall.lo.z = -impl::reach_limit, tall.hi.z = impl::reach_limit;
    placements_->visit(tall, [&](const Pose& pose, float) {
      const Box3d box = pose.world_box(placements_->shape());
      if (!box.overlaps(tall)) return;
      z.lo = std::min(z.lo, static_cast<float>(box.lo.z) - impl::position_slack);
      z.hi = std::max(z.hi, static_cast<float>(box.hi.z) + impl::position_slack);
    });
    return z;
  }

  Box3d bounds() const override { return placements_->bounds(); }
  float reach() const override { return child_->reach; }

 private:
  static Box3d intersection(const Box3d& a, const Box3d& b) {
    return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
            {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
  }

  /// Calls run(pose, scale) for each placement that touches some of the points, with those, seen from it, in
  /// scratch.points and their indices in scratch.items.
  template <class Run>
  void each_touched(std::span<const Vec3d> points, PointWork& work, const Run& run) const {
    auto& balls = work.scratch.balls;
    balls.clear();
    Box3d all;
    for (std::size_t i = 0; i < points.size(); i += pack) {
      Box3d box;
      for (const Vec3d& p : points.subspan(i, std::min(pack, points.size() - i))) box.expand(p);
      balls.push_back({box.center(), length(box.size()) / 2 + ball_slack});
      all.expand(box);
    }
    placements_->visit(all, [&](const Pose& pose, float scale) {
      if (!pose.own_box(all).overlaps(placements_->shape())) return;
      find_touched(points, pose, work.scratch);
      if (!work.scratch.points.empty()) run(pose, scale);
    });
  }

  void find_touched(std::span<const Vec3d> points, const Pose& pose, PointWork::Scratch& scratch) const {
    const Box3d& shape = placements_->shape();
    scratch.points.clear();
    scratch.items.clear();
    for (std::size_t b = 0; b < scratch.balls.size(); ++b) {
      const auto& ball = scratch.balls[b];
      if (!shape.grown(ball.radius * pose.inverse).contains(pose.to_own(ball.center))) continue;
      for (std::size_t i = b * pack; i < std::min((b + 1) * pack, points.size()); ++i) {
        const Vec3d p = pose.to_own(points[i]);
        if (!shape.contains(p)) continue;
        scratch.points.push_back(p);
        scratch.items.push_back(static_cast<std::uint32_t>(i));
      }
    }
  }

  static constexpr std::size_t pack = 8;  ///< neighbours that are left out together
  std::shared_ptr<const Program> child_;
  std::shared_ptr<const Placements> placements_;
};

class InstanceNode final : public impl::NestedNode {
 public:
  InstanceNode(NodePtr child, std::shared_ptr<const Placements> placements)
      : child_(std::move(child)), placements_(std::move(placements)) {}
  std::shared_ptr<const impl::Nested> compile(impl::Compiler& compiler) const override {
    return std::make_shared<Instanced>(compiler.program(child_), placements_);
  }
  NodePtr child() const override { return child_; }
  Box3d support(const Box3d&) const override { return placements_->bounds(); }
  void each_pose(const std::function<void(const Pose*)>& visit) const override {
    placements_->visit(placements_->bounds(), [&](const Pose& pose, float) { visit(&pose); });
  }
  std::uint64_t count() const override { return placements_->size(); }
  std::uint64_t bytes() const override { return sizeof(*this) + placements_->bytes(); }

 private:
  NodePtr child_;
  std::shared_ptr<const Placements> placements_;
};

}  // namespace

NodePtr instances(NodePtr shape, std::span<const Placement> placements) {
  const Box3d box = support(shape);
  if (!box.empty() && !box.bounded())
    fail(ErrorKind::usage,
         "only a tree that is 0 outside of a box can be instanced: leave heightfields, domains and constants "
         "out of it");
  if (box.empty() || placements.empty()) return constant(0);
  return impl::make_nested(
      std::make_unique<InstanceNode>(std::move(shape), std::make_shared<Placements>(box, placements)));
}

namespace operator_instance {
const OperatorType& declaration() {
  static const OperatorType type{
      .about =
          {.name = "instance",
           .doc =
               "Sum of many copies of a tree that vanishes outside of a box, each placed as transform does",
           .source = "[Paris19 §8.3]",
           .params = impl::placement_params()},
  };
  return type;
}
}  // namespace operator_instance

}  // namespace tafoni::field
