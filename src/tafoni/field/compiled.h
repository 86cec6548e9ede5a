#pragma once
// The compiled field: immutable, indexed, safe to query from any number of threads.

#include <memory>
#include <span>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/vec.h"

namespace tafoni::field {

namespace impl {
struct Program;
}

class CompiledField {
 public:
  /// f at a local position: metres only near untouched ground, else no more than a sign.
  float value(Vec3d p) const;
  /// f at many positions, in the order given; bit-identical to value() one by one.
  void values(std::span<const Vec3d> points, std::span<float> out) const;
  /// f and its analytic gradient. Where f is not differentiable, one side's gradient.
  void gradients(std::span<const Vec3d> points, std::span<float> values, std::span<Vec3f> gradients) const;
  /// Encloses every value of f over the box (local metres).
  Interval interval(const Box3d& box) const;
  /// A box that holds the whole surface f = 0, but for that of functions whose support has no end; empty when
  /// there is no other.
  Box3d bounds() const;

  const impl::Program& program() const { return *program_; }
  explicit CompiledField(std::shared_ptr<const impl::Program> program) : program_(std::move(program)) {}

 private:
  std::shared_ptr<const impl::Program> program_;
};

CompiledField compile(const NodePtr& root);

}  // namespace tafoni::field
