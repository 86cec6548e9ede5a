#pragma once
// Leaves that are neither rasters nor primitives: functions from outside, and trees asked at other positions.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>

#include "tafoni/field/impl/kernels.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

class Compiler;
class PointWork;
struct Pose;
struct Program;

/// The compiled leaf. `work` is scratch of the leaf's own, of one thread; nothing is kept in it from call to
/// call.
class Nested {
 public:
  virtual ~Nested() = default;
  /// out[i] is the value at points[i], the same bits whatever other points are asked along.
  virtual void values(std::span<const Vec3d> points, PointWork& work, float* out) const = 0;
  /// Lane i % 8 of out[i / 8]; the values are those of values(). Lanes beyond the points may hold anything
  /// finite.
  virtual void gradients(std::span<const Vec3d> points, PointWork& work, PointValues* out) const = 0;
  /// Encloses every value over the box.
  virtual Interval range(const Box3d& box, PointWork& work) const = 0;
  /// Elevations over the column's x and y beyond which the leaf mostly stays as it is; lo > hi for none.
  /// A hint: it saves asking range() there.
  virtual Interval extent(const Box3d& column, PointWork& work) const = 0;
  /// The program that has this leaf's values over the box bit for bit; null for none.
  virtual const Program* still(const Box3d&) const { return nullptr; }
  /// Holds the surface where it is known to be bounded; empty where nothing is known.
  virtual Box3d bounds() const = 0;
  /// Mean radius of the primitives' supports, metres; 0 without primitives.
  virtual float reach() const { return 0; }
};

/// What a node of the tree holds: pure data that can be compiled.
class NestedNode {
 public:
  virtual ~NestedNode() = default;
  virtual std::shared_ptr<const Nested> compile(Compiler& compiler) const = 0;
  /// The tree that is asked elsewhere; null for a function.
  virtual NodePtr child() const { return nullptr; }
  /// How many operators that move space lie one in another, below this one.
  virtual int depth_below() const { return 0; }
  /// Outside of it the value is exactly 0, given the same of the child.
  virtual Box3d support(const Box3d& child) const = 0;
  /// Calls visit(pose) for each place at which the child stands; null where it stays.
  virtual void each_pose(const std::function<void(const Pose*)>& visit) const { visit(nullptr); }
  virtual std::uint64_t count() const { return 1; }
  virtual std::uint64_t bytes() const = 0;
};

/// A function whose evaluation evaluates trees.
class HidesTrees {
 public:
  virtual ~HidesTrees() = default;
  /// How many operators that move space lie one in another in it.
  virtual int depth() const = 0;
};
int depth_of(const Function* function);

/// The extent of what has none.
inline constexpr Interval no_extent{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};

/// Refuses a node that lies deeper than what evaluation, which is recursive here, is meant for.
NodePtr make_nested(std::unique_ptr<const NestedNode> content);

}  // namespace tafoni::field::impl
