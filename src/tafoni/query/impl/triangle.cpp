// One triangle against a ray, a point, a segment and a moving capsule. The moving capsule is a moving point
// against the triangle rounded and stretched along the capsule's axis.

#include "tafoni/query/impl/triangle.h"

#include <limits>
#include <numbers>

#include "tafoni/query/impl/tolerance.h"

namespace tafoni::query::impl {
namespace {

double squared(Vec3d a) {
  return dot(a, a);
}

Vec3d nearest_on_segment(Vec3d a, Vec3d b, Vec3d p) {
  const Vec3d along = b - a;
  const double full = squared(along);
  return full > 0 ? a + along * std::clamp(dot(p - a, along) / full, 0.0, 1.0) : a;
}

/// Nearest points of two segments, either of which may be a point.
NearestPair nearest_of_segments(Vec3d a0, Vec3d a1, Vec3d b0, Vec3d b1) {
  const Vec3d u = a1 - a0, v = b1 - b0, w = a0 - b0;
  const double uu = squared(u), uv = dot(u, v), vv = squared(v), uw = dot(u, w), vw = dot(v, w);
  const double det = uu * vv - uv * uv;
  double s = det > 1e-14 * uu * vv ? std::clamp((uv * vw - vv * uw) / det, 0.0, 1.0) : 0.0;
  double t = vv > 0 ? (uv * s + vw) / vv : 0.0;
  if (t < 0 || t > 1 || vv <= 0) {
    t = std::clamp(t, 0.0, 1.0);
    s = uu > 0 ? std::clamp((uv * t - uw) / uu, 0.0, 1.0) : 0.0;
  }
  const Vec3d p = a0 + u * s, q = b0 + v * t;
  return {p, q, squared(p - q)};
}

/// The earliest contact found so far of a moving point with a rounded polyhedron.
struct Sweep {
  Vec3d from, motion;
  double radius;
  double best;  ///< only what is met before counts
  Vec3d point;
  bool met = false;

  void meet(double time, Vec3d at) { best = time, point = at, met = true; }

  /// The flat polygon corners[0 .. n) of unit normal `normal`, at `radius` from its plane.
  void face(const Vec3d* corners, int n, Vec3d normal) {
    double height = dot(from - corners[0], normal);
    if (height < 0) height = -height, normal = -normal;
    const double speed = -dot(motion, normal);
    if (!(speed > 0) || height < radius) return;
    const double time = (height - radius) / speed;
    if (!(time <= best)) return;
    const Vec3d at = from + motion * time - normal * radius;
    // The sign that all edges must agree on depends on which way round the corners go.
    bool left = false, right = false;
    for (int i = 0; i < n; ++i) {
      const Vec3d& p = corners[i];
      const double side = dot(cross(corners[(i + 1) % n] - p, at - p), normal);
      left = left || side > 0;
      right = right || side < 0;
    }
    if (!left || !right) meet(time, at);
  }

  void edge(Vec3d p, Vec3d q) {
    const Vec3d along = q - p, offset = from - p;
    const double full = squared(along);
    if (!(full > 0)) return;
    const double m_along = dot(motion, along) / full, o_along = dot(offset, along) / full;
    const Vec3d m = motion - along * m_along, o = offset - along * o_along;
    const double time = root(squared(m), dot(m, o), squared(o) - radius * radius);
    if (!(time <= best)) return;
    const double s = o_along + time * m_along;
    if (s >= 0 && s <= 1) meet(time, p + along * s);
  }

  void vertex(Vec3d p) {
    const Vec3d o = from - p;
    const double time = root(squared(motion), dot(motion, o), squared(o) - radius * radius);
    if (time <= best) meet(time, p);
  }

 private:
  /// The first root of a t^2 + 2 b t + c, if it is not behind; infinity else.
  static double root(double a, double b, double c) {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (!(a > 0) || b >= 0 || c < 0) return none;
    const double disc = b * b - a * c;
    // c / q instead of (-b - sqrt(disc)) / a, which loses digits where c is small.
    return disc < 0 ? none : c / (std::sqrt(disc) - b);
  }
};

/// What a capsule's axis sweeps against is the triangle and its copy moved by minus the axis, with the
/// parallelograms between them: their sum, whose surface the axis' start must not enter.
void sweep_prism(const Triangle& t, Vec3d normal, Vec3d axis, Sweep& sweep) {
  const Vec3d* v = t.v;
  const Vec3d far[3] = {v[0] - axis, v[1] - axis, v[2] - axis};
  const bool flat = squared(normal) == 0;
  if (!flat) {
    sweep.face(v, 3, normal);
    sweep.face(far, 3, normal);
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Vec3d corners[4] = {v[i], v[j], far[j], far[i]};
    const Vec3d side = cross(v[j] - v[i], axis);
    const double size = length(side);
    if (size > 1e-12 * length(axis) * length(v[j] - v[i])) sweep.face(corners, 4, side * (1 / size));
    sweep.edge(v[i], v[j]);
    sweep.edge(far[i], far[j]);
    sweep.edge(v[i], far[i]);
    sweep.vertex(v[i]);
    sweep.vertex(far[i]);
  }
}

/// Whether a point of the triangle's plane lies in the triangle.
bool inside(const Triangle& t, Vec3d p, Vec3d normal) {
  for (int i = 0; i < 3; ++i)
    if (dot(cross(t.v[(i + 1) % 3] - t.v[i], p - t.v[i]), normal) < 0) return false;
  return true;
}

/// Touching or overlap before the motion; a time above 1 for a shape that touches and does not come nearer.
/// Distance to a convex shape is convex along a line: who does not come nearer now never will.
std::optional<MovingHit> touch_at_start(const Triangle& t, Vec3d a, Vec3d b, double radius, Vec3d motion,
                                        bool sphere) {
  Vec3d on_shape = a, on_triangle;
  if (sphere) {
    on_triangle = nearest_point(t, a);
  } else {
    const NearestPair pair = nearest_pair(t, a, b);
    on_shape = pair.on_segment, on_triangle = pair.on_triangle;
  }
  const Vec3d gap = on_shape - on_triangle;
  const double distance = length(gap);
  if (distance > radius + touching) return {};
  if (distance < radius - touching) return MovingHit{.point = {}, .normal = {}, .overlap = true};
  const bool nearer = distance > 0 && dot(motion, gap) < -parallel * length(motion) * distance;
  return MovingHit{nearer ? 0.0 : 2.0, on_triangle, gap * (1 / std::max(distance, 1e-300))};
}

}  // namespace

// [Ericson05 §5.1.5]: by the region of the triangle that p projects to.
Vec3d nearest_point(const Triangle& t, Vec3d p) {
  const Vec3d ab = t.v[1] - t.v[0], ac = t.v[2] - t.v[0], ap = p - t.v[0];
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return t.v[0];
  const Vec3d bp = p - t.v[1];
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return t.v[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return nearest_on_segment(t.v[0], t.v[1], p);
  const Vec3d cp = p - t.v[2];
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return t.v[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return nearest_on_segment(t.v[0], t.v[2], p);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return nearest_on_segment(t.v[1], t.v[2], p);
  const double inv = 1 / (va + vb + vc);
  return t.v[0] + ab * (vb * inv) + ac * (vc * inv);
}

NearestPair nearest_pair(const Triangle& t, Vec3d a, Vec3d b) {
  if (const auto s = ray_hit(t, a, b - a); s && *s <= 1) {
    const Vec3d p = a + (b - a) * *s;
    return {p, p, 0};
  }
  NearestPair best{a, nearest_point(t, a), 0};
  best.squared = squared(a - best.on_triangle);
  const auto consider = [&](const NearestPair& pair) {
    if (pair.squared < best.squared) best = pair;
  };
  const Vec3d q = nearest_point(t, b);
  consider({b, q, squared(b - q)});
  for (int i = 0; i < 3; ++i) consider(nearest_of_segments(a, b, t.v[i], t.v[(i + 1) % 3]));
  return best;
}

std::optional<double> ray_hit(const Triangle& t, Vec3d from, Vec3d along) {
  const Vec3d a = t.v[0] - from, b = t.v[1] - from, c = t.v[2] - from;
  // cross(p, q) is exactly -cross(q, p), so that neighbours see the shared edge from exactly opposite sides.
  const double u = dot(cross(b, c), along), v = dot(cross(c, a), along), w = dot(cross(a, b), along);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return {};
  const double sum = u + v + w;
  if (sum == 0) return {};
  const double s = dot(a * (u / sum) + b * (v / sum) + c * (w / sum), along) / squared(along);
  return s >= 0 ? std::optional(s) : std::nullopt;
}

std::optional<MovingHit> moving_hit(const Triangle& t, Vec3d a, Vec3d b, double radius, Vec3d motion,
                                    double most) {
  const Vec3d axis = b - a;
  const bool sphere = squared(axis) == 0;
  const Vec3d n = t.cross();
  const double size = length(n);
  const Vec3d normal = size > 0 ? n * (1 / size) : Vec3d{};
  // The height over the triangle's plane, of the end that is nearer to it, on the side where the shape is.
  double lower = dot(a - t.v[0], normal), other = sphere ? lower : dot(b - t.v[0], normal);
  const double side = lower + other < 0 ? -1 : 1;
  Vec3d end = a;
  lower *= side, other *= side;
  if (other < lower) lower = other, end = b;
  if (lower > radius + touching) {
    const double speed = -side * dot(motion, normal);
    if (!(speed > 0)) return {};
    const double time = (lower - radius) / speed;
    if (time > most) return {};
    // The plane is met first; where that is inside the triangle, nothing else is met sooner.
    const Vec3d at = end + motion * time - normal * (side * radius);
    if (inside(t, at, n)) return MovingHit{time, at, normal * side};
  } else if (const auto now = touch_at_start(t, a, b, radius, motion, sphere)) {
    if (now->overlap || now->time <= most) return now;
    return {};
  }
  Sweep sweep{.from = a, .motion = motion, .radius = radius, .best = most, .point = {}};
  if (sphere) {
    for (int i = 0; i < 3; ++i) {
      sweep.edge(t.v[i], t.v[(i + 1) % 3]);
      sweep.vertex(t.v[i]);
    }
  } else {
    sweep_prism(t, normal, axis, sweep);
  }
  if (!sweep.met) return {};
  const Vec3d moved = motion * sweep.best;
  const Vec3d toward = normalized(a + moved - sweep.point);
  if (sphere) return MovingHit{sweep.best, sweep.point, toward};
  return MovingHit{sweep.best, nearest_pair(t, a + moved, b + moved).on_triangle, toward};
}

double angle_at(const Triangle& t, Vec3d q, double tolerance) {
  for (int i = 0; i < 3; ++i) {
    if (squared(q - t.v[i]) > tolerance * tolerance) continue;
    const Vec3d u = t.v[(i + 1) % 3] - t.v[i], v = t.v[(i + 2) % 3] - t.v[i];
    return std::atan2(length(cross(u, v)), dot(u, v)) / (2 * std::numbers::pi);
  }
  for (int i = 0; i < 3; ++i)
    if (squared(q - nearest_on_segment(t.v[i], t.v[(i + 1) % 3], q)) <= tolerance * tolerance) return 0.5;
  return 1;
}

}  // namespace tafoni::query::impl
