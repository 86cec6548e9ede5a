#pragma once
// What the program knows of a brush: a declaration, and how a stroke becomes primitives. A brush is one file
// in brushes/.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/registry.h"
#include "tafoni/math/vec.h"
#include "tafoni/scene/sculpt/stroke.h"

namespace tafoni::scene {

/// Takes what a brush makes of one stroke. Positions are local metres. The strength, the sign and the noise
/// on the metric [Paris19 §5.2] are the stroke's.
class Dab {
 public:
  virtual ~Dab() = default;
  /// A primitive of a registered kind, whose surface lies `radius` from its skeleton wherever it meets
  /// nothing but deep rock or open air. `extras` as the kind's record says.
  virtual void add(std::string_view kind, Vec3d anchor, double radius, std::span<const float> extras) = 0;
  void sphere(Vec3d center, double radius) { add("sphere", center, radius, {}); }
  /// A chain of spheres along `path`, whose radius is a function of the way covered, 0 at its begin and 1 at
  /// its end.
  template <class Radius>
  void tube(std::span<const Vec3d> path, Radius radius);
};

/// What a brush paints: weight into a mask, from the centre line outwards.
struct Painting {
  std::string mask = "region";
  double hardness = 0.5;  ///< part of the radius that gets the full weight
  bool erase = false;
};

struct BrushType {
  Declaration about = {};
  std::size_t min_points = 1, max_points = 100000;
  /// The stroke is checked and its points are local. `seed` decides what is random. Null for one that paints.
  void (*apply)(const Stroke& stroke, std::uint64_t seed, Dab& dab) = nullptr;
  /// What the stroke paints. Null for a brush that makes primitives.
  Painting (*paint)(const Stroke& stroke) = nullptr;
  /// Parameters that depend on others, beyond `params`; may be null.
  std::vector<ParamInfo> (*more)(const Values& values) = nullptr;
};

/// Every brush, sorted by name; brushes/NAME.cpp defines `const BrushType& declaration()` in its namespace
/// `brush_NAME`.
std::span<const BrushType* const> all_brushes();
/// Throws Error{usage} naming the nearest known one.
const BrushType& find_brush(std::string_view name);
std::vector<ParamInfo> params_of_brush(const BrushType& brush, const Values& values);

/// Throws Error{usage} for a stroke of more balls than any needs: a brush that makes many from few points
/// asks before it makes them.
void check_stroke_size(double balls);

/// How far the points of a path are apart, in radii of the tube along it: its balls are then spaced by half a
/// radius, whatever bends there are.
inline constexpr double path_spacing = 0.2;

/// A Catmull-Rom curve through `points`, or the points themselves joined by straight lines, as points no
/// further than `spacing` metres apart. Throws Error{usage} for what check_stroke_size() refuses.
std::vector<Vec3d> sample_path(std::span<const Vec3d> points, bool smooth, double spacing);

template <class Radius>
void Dab::tube(std::span<const Vec3d> path, Radius radius) {
  double whole = 0;
  for (std::size_t i = 1; i < path.size(); ++i) whole += length(path[i] - path[i - 1]);
  double covered = 0, next = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) covered += length(path[i] - path[i - 1]);
    if (covered < next && i + 1 < path.size()) continue;
    const double r = radius(whole > 0 ? covered / whole : 0);
    sphere(path[i], r);
    next = covered + 0.5 * r;
  }
}

}  // namespace tafoni::scene
