#pragma once
// The editable construction tree [Paris19 §3.1]: small immutable nodes with shared structure.
//
// Positions are double metres in the scene's local frame (world minus its origin). Fields are in the f - T
// frame: solid where f > 0; metres only near untouched ground. Nodes are pure data; see compiled.h.

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "tafoni/field/function.h"
#include "tafoni/math/vec.h"
#include "tafoni/raster/grid.h"

namespace tafoni::field {

class Node;
using NodePtr = std::shared_ptr<const Node>;

/// How far from the surface the heightfield's field reaches [Paris19 §5.1].
struct HeightfieldSettings {
  double influence = 15.0;  ///< R, metres; R <= 3T is enforced, or sigma would not be monotone
  double amplitude = 7.5;   ///< T, metres: the field's greatest magnitude
  bool bicubic = true;      ///< Catmull-Rom, C1; else bilinear
  bool first_order = true;  ///< v / sqrt(1 + |grad h|^2), else the vertical distance v of the paper
};

/// f_T = sigma(distance to the surface of `heights`). Heights are local metres, all finite; outside the
/// raster the nearest pixel's value continues.
NodePtr heightfield(std::shared_ptr<const raster::Raster> heights, const HeightfieldSettings& settings);

/// f_P = sigma(signed distance to the border of Omega x [base, infinity)), positive inside.
/// Omega is a rectangle, cut by an optional raster of signed distances in metres (positive inside,
/// interpolated bilinearly), which carries polygons, holes and missing data.
struct Domain {
  Box3d box;  ///< x and y limits; box.lo.z is the base; box.hi.z is not used
  std::shared_ptr<const raster::Raster> inside;  ///< may be null
};
NodePtr domain(const Domain& domain, const HeightfieldSettings& settings);

/// A field equal to `value` everywhere; -T under a union turns a cloud into a solid of its own.
NodePtr constant(float value);

/// Noise that perturbs the metric of a cloud's primitives [Paris19 §5.2]:
/// distance / (R + amplitude * (2 t(v / wavelength) - 1)) with t normalised fBm in [0, 1].
struct MetricNoise {
  double amplitude = 0;   ///< metres, below every primitive's radius; 0 switches it off
  double wavelength = 4;  ///< metres
  int octaves = 3;
  std::uint64_t seed = 0;
};

struct CloudSettings {
  std::string_view kind = "point";  ///< a registered primitive (primitive.h)
  double falloff = 15.0;            ///< metres over which a volumetric kind falls off beyond its body
  MetricNoise noise;
};

/// Collects like primitives into one node: their contributions energy * g(distance) are summed.
/// The node does not depend on the order of add().
class CloudBuilder {
 public:
  explicit CloudBuilder(const CloudSettings& settings);
  ~CloudBuilder();
  CloudBuilder(CloudBuilder&&) noexcept;
  CloudBuilder& operator=(CloudBuilder&&) noexcept;

  /// `anchor` in local metres; `shape` as the kind's record says (primitive.h), e.g. {radius} for a point,
  /// {radius, dx, dy, dz} for a segment. `energy` in metres; negative carves.
  /// Throws Error{input} for what is not finite, not positive where it must be, or beyond 131 km.
  void add(Vec3d anchor, float energy, std::span<const float> shape);
  std::size_t size() const;
  /// Sorts, quantizes (2^-13 m) and indexes. Leaves the builder empty.
  NodePtr finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Shorthand for the kinds. Radii and energies in metres.
void add_point(CloudBuilder& cloud, Vec3d center, double radius, double energy);
void add_segment(CloudBuilder& cloud, Vec3d from, Vec3d to, double radius, double energy);
/// A Catmull-Rom curve through `points` (at least two), as a chain of segments no further than `tolerance`
/// metres from it.
void add_curve(CloudBuilder& cloud, std::span<const Vec3d> points, double radius, double energy,
               double tolerance = 0.05);

/// The sum of the trees. A cloud adds its primitives one by one, in the cloud's order, to what stands before
/// it. Takes at least one tree that is not null, as do the next three; one alone is returned as it is.
NodePtr blend(std::vector<NodePtr> trees);
/// Solid where any tree is: the greatest value.
NodePtr unite(std::vector<NodePtr> trees);
/// Solid where all trees are: the least value.
NodePtr intersect(std::vector<NodePtr> trees);
/// Solid where `from` is and none of `what`: min(from, -what).
NodePtr subtract(NodePtr from, NodePtr what);
/// A node of the combining operator of this name (operator.h), from the left; its parameter is the default.
/// Throws Error{usage} for a name that is none.
NodePtr combine(std::string_view op, std::vector<NodePtr> trees);

/// a (1 - alpha) + b alpha [Zawadzki]; alpha in [0, 1].
NodePtr morph(NodePtr a, NodePtr b, double alpha);

/// Solid where both are, and their common edge is worn off: min(a, b) - h^2 / (4 width) with h = width - |a -
/// b| where that is positive, and exactly the lesser elsewhere. The edge of two faces at a right angle
/// recedes by 0.35 width. `width` in metres of the values, above 0. Throws Error{usage} for another.
NodePtr round_edge(NodePtr a, NodePtr b, double width);

/// A leaf with the function's own values, in metres.
NodePtr function(FunctionPtr f);
/// A tree's values, clamped to [lo, hi]: a control field for warp() and erode() made of primitives.
FunctionPtr as_function(const NodePtr& tree, float lo = 0, float hi = 1);

/// f - depth * control * (1 - resistance) ([Paris19 §5.3], in metres). `control` in [0, 1], null
/// for 1 everywhere; exactly 0 where nothing shall happen. `resistance` in [0, 1], null for one half. A depth
/// below the terrain's T leaves deep rock solid.
NodePtr erode(NodePtr below, FunctionPtr control, FunctionPtr resistance, double depth);

/// Displacement of a warp: three independent normalised fBm in [-1, 1], each times its amplitude.
struct WarpSettings {
  Vec3d amplitude{2, 2, 1};  ///< metres; greatest displacement along each axis
  double lateral = 20;       ///< wavelength along x and y, metres
  double vertical = 20;      ///< wavelength along z, metres
  int octaves = 3;
  std::uint64_t seed = 0;
};
/// f(p + delta(p) control(p)) [Paris19 §5.3]. `control` as in erode().
NodePtr warp(NodePtr below, FunctionPtr control, const WarpSettings& settings);

/// Where a copy stands: p_placed = position + scale * Rz(turn) Ry(tilt) p_own.
struct Placement {
  Vec3d position;
  double turn = 0, tilt = 0;  ///< radians: about z, counter-clockwise from above, after about y
  double scale = 1;           ///< lengths and field values alike, so that the field stays in metres
};
/// The tree moved, turned and scaled.
NodePtr transform(NodePtr tree, const Placement& placement);
/// The sum of copies of a tree of compact support (support() is bounded), at 64 bytes a copy or less. Copies
/// are found by an index; they add up in an order that does not depend on the order given.
NodePtr instances(NodePtr shape, std::span<const Placement> placements);

/// A box outside of which the tree is exactly 0; everything where there is no such box. Empty for a tree that
/// is 0.
Box3d support(const NodePtr& tree);

struct TreeStats {
  std::uint64_t nodes = 0;  ///< primitives, operators and heightfields, as [Paris19]'s #N counts
  std::uint64_t primitives = 0;
  std::uint64_t bytes = 0;  ///< without the heightfield's raster
};
TreeStats stats(const NodePtr& root);

/// The share of `area` (x and y) that lies above or below the support of a primitive: the ratio a of
/// [Paris19 §7], found on cells of size `cell`, metres.
double coverage(const NodePtr& root, const Box3d& area, double cell);

}  // namespace tafoni::field
