// Leaves made of functions, and functions made of trees; what nested nodes share.

#include "tafoni/field/function.h"

// Functions of space as leaves of a tree, and trees as functions. A gradient is taken from four corners of a
// tetrahedron, the fewest from which all three slopes follow.
#include <algorithm>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/impl/points.h"

namespace tafoni::field {

void Function::gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const {
  constexpr std::size_t batch = 32;  // points at a time: their corners fit the stack
  constexpr std::size_t corners = 4;
  constexpr Vec3d corner[corners] = {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}};
  const double h = step();
  const auto scale = static_cast<float>(0.25 / h);
  Vec3d around[corners * batch];
  float f[corners * batch];
  for (std::size_t begin = 0; begin < points.size(); begin += batch) {
    const std::size_t n = std::min(batch, points.size() - begin);
    for (std::size_t i = 0; i < corners * n; ++i)
      around[i] = points[begin + i / corners] + corner[i % corners] * h;
    values({around, corners * n}, {f, corners * n});
    for (std::size_t i = 0; i < n; ++i) {
      const float* at = f + corners * i;
      const float a = at[3] - at[2], b = at[0] - at[1], c = at[3] - at[0], d = at[2] - at[1];
      out[begin + i] = {(a + b) * scale, (c + d) * scale, (a - b) * scale};
    }
  }
}

namespace {

class FunctionLeaf final : public impl::Nested {
 public:
  explicit FunctionLeaf(FunctionPtr f) : f_(std::move(f)) {}

  void values(std::span<const Vec3d> points, impl::PointWork&, float* out) const override {
    f_->values(points, {out, points.size()});
  }
  void gradients(std::span<const Vec3d> points, impl::PointWork& work,
                 impl::PointValues* out) const override {
    auto& values = work.scratch.values;
    auto& slopes = work.scratch.slopes;
    values.resize(points.size());
    slopes.resize(points.size());
    f_->values(points, values);
    f_->gradients(points, slopes);
    for (std::size_t i = 0; i < (points.size() + 7) / 8 * 8; ++i) {
      const std::size_t from = std::min(i, points.size() - 1), lane = i % 8;
      impl::PointValues& p = out[i / 8];
      p.v[lane] = values[from];
      p.gx[lane] = slopes[from].x, p.gy[lane] = slopes[from].y, p.gz[lane] = slopes[from].z;
    }
  }
  Interval range(const Box3d& box, impl::PointWork&) const override { return f_->range(box); }
  Interval extent(const Box3d&, impl::PointWork&) const override { return impl::no_extent; }
  Box3d bounds() const override {
    const Box3d box = f_->support();
    return box.bounded() ? box : Box3d{};
  }

 private:
  FunctionPtr f_;
};

class FunctionNode final : public impl::NestedNode {
 public:
  explicit FunctionNode(FunctionPtr f) : f_(std::move(f)) {}
  std::shared_ptr<const impl::Nested> compile(impl::Compiler&) const override {
    return std::make_shared<FunctionLeaf>(f_);
  }
  int depth_below() const override { return impl::depth_of(f_.get()); }
  Box3d support(const Box3d&) const override { return f_->support(); }
  std::uint64_t bytes() const override { return sizeof(*this); }

 private:
  FunctionPtr f_;
};

class TreeFunction final : public Function, public impl::HidesTrees {
 public:
  TreeFunction(const NodePtr& tree, float lo, float hi)
      : depth_(tree->depth), support_(field::support(tree)), field_(compile(tree)), lo_(lo), hi_(hi) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field_.values(points, out);
    for (float& v : out) v = std::clamp(v, lo_, hi_);
  }
  void gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const override {
    std::vector<float> f(points.size());
    field_.gradients(points, f, out);
    for (std::size_t i = 0; i < f.size(); ++i)
      if (f[i] < lo_ || f[i] > hi_) out[i] = {};
  }
  Interval range(const Box3d& box) const override {
    const Interval r = field_.interval(box);
    return {std::clamp(r.lo, lo_, hi_), std::clamp(r.hi, lo_, hi_)};
  }
  Box3d support() const override { return lo_ <= 0 && hi_ >= 0 ? support_ : Box3d::everything(); }
  int depth() const override { return depth_; }

 private:
  int depth_;
  Box3d support_;
  CompiledField field_;
  float lo_, hi_;
};

}  // namespace

int impl::depth_of(const Function* function) {
  const auto* hides = dynamic_cast<const HidesTrees*>(function);
  return hides ? hides->depth() : 0;
}

NodePtr impl::make_nested(std::unique_ptr<const NestedNode> content) {
  auto node = std::make_shared<Node>(std::move(content));
  constexpr int limit = 64;  // each level asks the next in a call: the stack must hold all of them
  if (node->depth > limit)
    fail(ErrorKind::usage, "operators that move space lie more than {} deep in one another; remove some",
         limit);
  return node;
}

NodePtr function(FunctionPtr f) {
  if (!f) fail(ErrorKind::internal, "a function leaf has no function");
  return impl::make_nested(std::make_unique<FunctionNode>(std::move(f)));
}

FunctionPtr as_function(const NodePtr& tree, float lo, float hi) {
  if (!(lo <= hi)) fail(ErrorKind::usage, "a control field's limits are reversed");
  return std::make_shared<TreeFunction>(tree, lo, hi);
}

}  // namespace tafoni::field
