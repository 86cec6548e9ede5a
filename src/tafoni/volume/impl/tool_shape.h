#pragma once
// What a tool holds. Loops over many samples visit the variant once and then work on the shape itself.

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "tafoni/volume/tool.h"

namespace tafoni::volume {

namespace impl {

using Span = Tool::Span;

/// Empty unless lo < hi.
inline std::optional<Span> span(double lo, double hi) {
  if (!(lo < hi)) return std::nullopt;
  return Span{lo, hi};
}

struct Sphere {
  Vec3d center;
  double radius;

  Box3d bounds() const { return Box3d{center, center}.grown(radius); }
  double distance(Vec3d p) const { return radius - length(p - center); }
  std::optional<Span> column(double x, double y) const {
    const double dx = x - center.x, dy = y - center.y;
    const double left = radius * radius - (dx * dx + dy * dy);
    if (!(left > 0)) return std::nullopt;
    const double half = std::sqrt(left);
    return span(center.z - half, center.z + half);
  }
};

struct Capsule {
  Vec3d from, to;
  double radius;

  Box3d bounds() const {
    Box3d box{from, from};
    box.expand(to);
    return box.grown(radius);
  }
  double distance(Vec3d p) const {
    const Vec3d axis = to - from, d = p - from;
    const double square = dot(axis, axis);
    const double t = square > 0 ? std::clamp(dot(d, axis) / square, 0.0, 1.0) : 0.0;
    return radius - length(d - axis * t);
  }
  std::optional<Span> column(double x, double y) const;
};

struct TurnedBox {
  Vec3d center, half;
  double cosine, sine;  ///< of the turn about z

  Box3d bounds() const {
    const double c = std::abs(cosine), s = std::abs(sine);
    const Vec3d reach{c * half.x + s * half.y, s * half.x + c * half.y, half.z};
    return {center - reach, center + reach};
  }
  Vec3d own(Vec3d p) const {
    const Vec3d d = p - center;
    return {cosine * d.x + sine * d.y, cosine * d.y - sine * d.x, d.z};
  }
  double distance(Vec3d p) const {
    const Vec3d q = own(p);
    const Vec3d over{std::abs(q.x) - half.x, std::abs(q.y) - half.y, std::abs(q.z) - half.z};
    const double most = std::max({over.x, over.y, over.z});
    if (most <= 0) return -most;
    return -length(Vec3d{std::max(over.x, 0.0), std::max(over.y, 0.0), std::max(over.z, 0.0)});
  }
  std::optional<Span> column(double x, double y) const {
    const Vec3d q = own({x, y, center.z});
    if (!(std::abs(q.x) < half.x && std::abs(q.y) < half.y)) return std::nullopt;
    return span(center.z - half.z, center.z + half.z);
  }
};

/// The half space dot(normal, p) <= offset.
struct Plane {
  Vec3d normal;  ///< unit
  double offset;
};

struct Hull {
  std::vector<Plane> upper, lower, walls;  ///< by the sign of normal.z
  std::vector<Vec3d> corners;              ///< every corner, and perhaps points on edges and sides

  Box3d bounds() const {
    Box3d box;
    for (Vec3d c : corners) box.expand(c);
    return box;
  }
  double distance(Vec3d p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto* side : {&upper, &lower, &walls})
      for (const Plane& plane : *side) least = std::min(least, plane.offset - dot(plane.normal, p));
    return least;
  }
  std::optional<Span> column(double x, double y) const {
    for (const Plane& w : walls)
      if (!(w.normal.x * x + w.normal.y * y < w.offset)) return std::nullopt;
    double lo = -std::numeric_limits<double>::infinity(), hi = std::numeric_limits<double>::infinity();
    for (const Plane& u : upper) hi = std::min(hi, (u.offset - u.normal.x * x - u.normal.y * y) / u.normal.z);
    for (const Plane& l : lower) lo = std::max(lo, (l.offset - l.normal.x * x - l.normal.y * y) / l.normal.z);
    return span(lo, hi);
  }
};

/// Throws Error{usage} for points that lie in a plane, to 1e-9 of their extent.
Hull convex_hull(std::span<const Vec3d> points);

}  // namespace impl

struct Tool::Shape {
  std::variant<impl::Sphere, impl::Capsule, impl::TurnedBox, impl::Hull> solid;
};

}  // namespace tafoni::volume
