#pragma once
// A scalar function of position given from outside the tree: a geology, a region, a sampled volume.

#include <limits>
#include <memory>
#include <span>

#include "tafoni/math/vec.h"

namespace tafoni::field {

/// Immutable and safe to ask from any number of threads. Positions are local metres.
class Function {
 public:
  virtual ~Function() = default;
  /// out[i] is the value at points[i]: finite, and the same bits whatever other points are asked along with
  /// it.
  virtual void values(std::span<const Vec3d> points, std::span<float> out) const = 0;
  /// Per metre. Unless overridden, from the corners of a tetrahedron, step() away along each axis.
  virtual void gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const;
  virtual double step() const { return 0.05; }
  /// Encloses every value over the box. The tighter, the more is pruned.
  virtual Interval range(const Box3d& box) const = 0;
  /// A box outside of which the function is exactly 0. Unless overridden, everything.
  virtual Box3d support() const { return Box3d::everything(); }
};
using FunctionPtr = std::shared_ptr<const Function>;

}  // namespace tafoni::field
