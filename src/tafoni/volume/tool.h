#pragma once
// Tools: convex shapes that remove or add material ([Boggus], [Ruths01]).

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::volume {

/// A tool as plain numbers, for files and messages.
struct ToolData {
  enum class Kind : std::uint8_t { sphere, capsule, box, hull };
  Kind kind = Kind::sphere;
  std::vector<Vec3d> points;  ///< what moves with it: the centre; both ends; the centre; corners
  std::vector<double> sizes;  ///< radius; radius; half x, y, z, cosine and sine of the turn; none
  friend bool operator==(const ToolData&, const ToolData&) = default;
};

/// An immutable convex solid. Local metres. Cheap to copy.
class Tool {
 public:
  /// Each of these throws Error{usage} for what is not finite or has no inside.
  static Tool sphere(Vec3d center, double radius);
  /// All that lies within `radius` of the segment.
  static Tool capsule(Vec3d from, Vec3d to, double radius);
  /// `half` sides; turned by `turn` radians about z, counter-clockwise from above.
  static Tool box(Vec3d center, Vec3d half, double turn = 0);
  /// The convex hull of at least four points that do not lie in a plane.
  static Tool hull(std::span<const Vec3d> points);
  /// What data() gave: the same solid, bit for bit, but for a hull, which is made from its corners anew.
  /// Throws Error{usage} for what no tool gives.
  static Tool from(const ToolData& data);
  ToolData data() const;

  Box3d bounds() const;
  /// Metres to the border, positive inside, negative outside. Exact for sphere, capsule and box. Of a hull
  /// exact inside; outside, the distance to the plane that lies furthest, which is no more than the true one.
  double distance(Vec3d p) const;
  struct Span {
    double lo, hi;  ///< z, lo < hi
  };
  /// Where the vertical line at (x, y) passes through the inside [Boggus §3].
  std::optional<Span> column(double x, double y) const;

  struct Shape;
  const Shape& shape() const { return *shape_; }

 private:
  explicit Tool(std::shared_ptr<const Shape> shape) : shape_(std::move(shape)) {}
  std::shared_ptr<const Shape> shape_;
};

enum class Edit { remove, add };

}  // namespace tafoni::volume
