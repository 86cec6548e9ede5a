// Tools are made here, checked, and given as plain numbers; what they do lies in their shapes
// (impl/tool_shape.h).

#include "tafoni/volume/tool.h"

#include "tafoni/core/error.h"
#include "tafoni/volume/impl/tool_shape.h"

namespace tafoni::volume {

namespace {

bool finite(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void check(bool good, const char* what) {
  if (!good) fail(ErrorKind::usage, "{} is not finite or not above 0; give metres above 0", what);
}

void check_radius(double radius, const char* what) {
  check(std::isfinite(radius) && radius > 0, what);
}

}  // namespace

std::optional<Tool::Span> impl::Capsule::column(double x, double y) const {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  const auto take = [&](double a, double b) {
    if (!(a < b)) return;
    lo = std::min(lo, a);
    hi = std::max(hi, b);
  };
  for (Vec3d end : {from, to})
    if (const auto cap = Sphere{end, radius}.column(x, y)) take(cap->lo, cap->hi);

  // The cylinder between the caps, along p(z) = (x, y, z): |d|^2 - (d.axis)^2 / axis^2 < radius^2 where
  // d = p - from and 0 < d.axis < axis^2.
  const Vec3d axis = to - from;
  const double square = dot(axis, axis), flat = axis.x * axis.x + axis.y * axis.y;
  if (square > 0) {
    const double dx = x - from.x, dy = y - from.y, along = dx * axis.x + dy * axis.y;
    const double side = dx * axis.y - dy * axis.x;
    const double left = radius * radius * flat - side * side;
    double a = -std::numeric_limits<double>::infinity(), b = -a;
    if (flat > 0) {
      // The middle and the half width between the roots of the quadratic flat z^2 - 2 z along axis.z + ….
      const double half = left > 0 ? std::sqrt(left * square) / flat : 0.0, middle = along * axis.z / flat;
      a = middle - half, b = middle + half;
    } else if (!(dx * dx + dy * dy < radius * radius)) {
      b = a;
    }
    if (axis.z != 0) {
      const double first = -along / axis.z, last = (square - along) / axis.z;
      a = std::max(a, std::min(first, last));
      b = std::min(b, std::max(first, last));
    } else if (!(along > 0 && along < square)) {
      b = a;
    }
    take(from.z + a, from.z + b);
  }
  return span(lo, hi);
}

Tool Tool::sphere(Vec3d center, double radius) {
  check(finite(center), "the centre of a sphere");
  check_radius(radius, "the radius of a sphere");
  return Tool(std::make_shared<Shape>(Shape{impl::Sphere{center, radius}}));
}

Tool Tool::capsule(Vec3d from, Vec3d to, double radius) {
  check(finite(from) && finite(to), "an end of a capsule");
  check_radius(radius, "the radius of a capsule");
  return Tool(std::make_shared<Shape>(Shape{impl::Capsule{from, to, radius}}));
}

Tool Tool::box(Vec3d center, Vec3d half, double turn) {
  check(finite(center) && std::isfinite(turn), "the centre or the turn of a box");
  check(finite(half) && half.x > 0 && half.y > 0 && half.z > 0, "half a side of a box");
  return Tool(std::make_shared<Shape>(Shape{impl::TurnedBox{center, half, std::cos(turn), std::sin(turn)}}));
}

Tool Tool::hull(std::span<const Vec3d> points) {
  check(std::all_of(points.begin(), points.end(), finite), "a point of a hull");
  return Tool(std::make_shared<Shape>(Shape{impl::convex_hull(points)}));
}

Tool Tool::from(const ToolData& data) {
  constexpr std::size_t points[] = {1, 2, 1}, sizes[] = {1, 1, 5, 0};
  const auto kind = static_cast<std::size_t>(data.kind);
  const auto& p = data.points;
  const auto& s = data.sizes;
  const bool hull = data.kind == ToolData::Kind::hull;
  if (kind >= std::size(sizes) || s.size() != sizes[kind] || (!hull && p.size() != points[kind]))
    fail(ErrorKind::usage, "{} points and {} sizes make no tool of kind {}", p.size(), s.size(), kind);
  if (hull) return Tool::hull(p);
  if (data.kind == ToolData::Kind::sphere) return sphere(p[0], s[0]);
  if (data.kind == ToolData::Kind::capsule) return capsule(p[0], p[1], s[0]);
  check(std::abs(s[3] * s[3] + s[4] * s[4] - 1) < 1e-9, "the turn of a box");
  (void)Tool::box(p[0], {s[0], s[1], s[2]});  // checks them
  return Tool(std::make_shared<Shape>(Shape{impl::TurnedBox{p[0], {s[0], s[1], s[2]}, s[3], s[4]}}));
}

namespace {

ToolData data_of(const impl::Sphere& s) {
  return {ToolData::Kind::sphere, {s.center}, {s.radius}};
}
ToolData data_of(const impl::Capsule& c) {
  return {ToolData::Kind::capsule, {c.from, c.to}, {c.radius}};
}
ToolData data_of(const impl::TurnedBox& b) {
  return {ToolData::Kind::box, {b.center}, {b.half.x, b.half.y, b.half.z, b.cosine, b.sine}};
}
ToolData data_of(const impl::Hull& h) {
  return {ToolData::Kind::hull, h.corners, {}};
}

}  // namespace

ToolData Tool::data() const {
  return std::visit([](const auto& solid) { return data_of(solid); }, shape_->solid);
}

Box3d Tool::bounds() const {
  return std::visit([](const auto& solid) { return solid.bounds(); }, shape_->solid);
}

double Tool::distance(Vec3d p) const {
  return std::visit([p](const auto& solid) { return solid.distance(p); }, shape_->solid);
}

std::optional<Tool::Span> Tool::column(double x, double y) const {
  return std::visit([=](const auto& solid) { return solid.column(x, y); }, shape_->solid);
}

}  // namespace tafoni::volume
