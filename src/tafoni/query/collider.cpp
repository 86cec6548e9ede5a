// Every query once: a search walks the trees along a path or around a point, cut into pieces of a stride, and
// keeps the best of what single triangles (impl/triangle.h) answer.

#include "tafoni/query/collider.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/query/impl/tolerance.h"
#include "tafoni/query/impl/triangle.h"
#include "tafoni/query/impl/triangle_tree.h"

namespace tafoni::query {

using impl::Triangle;
using impl::TriangleTree;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Ways longer than this many strides are first asked whether there is any surface along them.
constexpr double worth_asking = 8;
/// How far, in strides, the surface is searched for from a place deep in the rock.
constexpr double deep_search = 64;

/// Metres. Nothing is searched for beyond.
constexpr double farthest = 1e7;

/// Metres. Squares of what is larger may be no numbers.
constexpr double immense = 1e150;

bool finite(Vec3d p) {
  return std::abs(p.x) < immense && std::abs(p.y) < immense && std::abs(p.z) < immense;
}

void check(Vec3d p, const char* what) {
  if (!finite(p)) fail(ErrorKind::usage, "{} is not finite: give numbers in metres", what);
}

void check(const Capsule& shape) {
  check(shape.a, "the shape's position");
  check(shape.b, "the shape's position");
  if (!(shape.radius > 0) || !std::isfinite(shape.radius))
    fail(ErrorKind::usage, "a radius of {} m cannot collide: give one above 0, or ask for a ray or a point",
         shape.radius);
}

void check_distance(double distance) {
  if (!(distance >= 0))
    fail(ErrorKind::usage, "a distance of {} m cannot be searched: give 0 or more", distance);
}

Box3d box_of(Vec3d p, Vec3d q) {
  Box3d box;
  box.expand(p);
  box.expand(q);
  return box;
}

double distance_to(const Box3d& box, Vec3d p) {
  const auto off = [](double lo, double hi, double v) { return std::max({lo - v, v - hi, 0.0}); };
  return length(
      Vec3d{off(box.lo.x, box.hi.x, p.x), off(box.lo.y, box.hi.y, p.y), off(box.lo.z, box.hi.z, p.z)});
}

/// What both hold; empty where that is nothing.
Box3d common(const Box3d& a, const Box3d& b) {
  return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
          {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
}

/// Cuts [begin, end] to the shares of the way at which a box of half sides `half` may touch `bounds`.
bool clip(Vec3d from, Vec3d along, Vec3d half, const Box3d& bounds, double& begin, double& end) {
  const auto axis = [&](double p, double d, double h, double lo, double hi) {
    if (d == 0) return p + h >= lo && p - h <= hi;
    const double s = (lo - h - p) / d, t = (hi + h - p) / d;
    begin = std::max(begin, std::min(s, t));
    end = std::min(end, std::max(s, t));
    return begin <= end;
  };
  return axis(from.x, along.x, half.x, bounds.lo.x, bounds.hi.x) &&
         axis(from.y, along.y, half.y, bounds.lo.y, bounds.hi.y) &&
         axis(from.z, along.z, half.z, bounds.lo.z, bounds.hi.z);
}

/// How far a shape whose axis meets the triangle has to go along its normal to be free of it.
double depth_of(const Triangle& triangle, const Capsule& shape, const impl::NearestPair& pair) {
  const Vec3d n = normalized(triangle.cross());
  return shape.radius + std::max(dot(pair.on_triangle - shape.a, n), dot(pair.on_triangle - shape.b, n));
}

/// Forwards to `found` and keeps what it says is still of interest.
struct Tracker {
  double (*found)(void*, const Triangle&, double);
  void* context;
  double limit;

  double look(const Triangle& triangle, double) {
    return limit = std::min(limit, found(context, triangle, limit));
  }
};

/// What a search does with a triangle, as the plain function that trees call.
template <class Search>
double look(void* search, const Triangle& triangle, double limit) {
  return static_cast<Search*>(search)->look(triangle, limit);
}

}  // namespace

/// Calls found(context, triangle, end) for triangles that the shape may meet on its way; it gives the share
/// of the way still of interest, below 0 to stop.
void Collider::search_along(Vec3d from, Vec3d along, Vec3d half, double radius, Found found,
                            void* context) const {
  const Vec3d sides = Vec3d{std::abs(half.x), std::abs(half.y), std::abs(half.z)} +
                      Vec3d{radius + impl::touching, radius + impl::touching, radius + impl::touching};
  double begin = 0, end = 1;
  const Box3d everything = bounds();
  if (everything.empty() || !clip(from, along, sides, everything, begin, end)) return;
  Tracker tracker{found, context, end};
  const double whole = length(along), piece = stride();
  const auto search = [&](auto& self, double s, double t) -> void {
    if (s > tracker.limit) return;
    Box3d box = box_of(from + along * s, from + along * t);
    // A shape may be larger than all ground.
    box = common({box.lo - sides, box.hi + sides}, everything);
    if (box.empty()) return;
    const double size = (t - s) * whole;
    if (size > worth_asking * piece && empty(box)) return;
    const double middle = s + (t - s) / 2;
    // Shares of an immense way may be too coarse to be halved.
    if (size > piece && s < middle && middle < t) {
      self(self, s, middle);
      self(self, middle, t);
      return;
    }
    struct Ask {
      const TriangleTree::Path path;
      Tracker& tracker;
    } ask{{from, along, half, radius + impl::touching, s, t}, tracker};
    visit(box, [&ask](const TriangleTree& tree) {
      TriangleTree::Path path = ask.path;
      path.end = std::min(path.end, ask.tracker.limit);
      if (path.begin <= path.end) tree.along(path, &look<Tracker>, &ask.tracker);
    });
  };
  search(search, begin, end);
}

/// Calls found(context, triangle, distance) for triangles that may lie within the distance, which it may
/// lower; below 0 to stop.
void Collider::search_around(Vec3d p, double distance, Found found, void* context) const {
  const Box3d everything = bounds();
  if (everything.empty()) return;
  const double piece = stride();
  Tracker tracker{found, context, piece == infinity ? distance : std::min(distance, farthest)};
  const auto ask = [&](const Box3d& box) {
    struct Ask {
      Vec3d p;
      Tracker& tracker;
    } around{p, tracker};
    visit(box, [&around](const TriangleTree& tree) {
      if (around.tracker.limit >= 0)
        tree.around(around.p, around.tracker.limit, &look<Tracker>, &around.tracker);
    });
  };
  if (piece == infinity) return ask(everything);
  const auto search = [&](auto& self, const Box3d& box) -> void {
    if (distance_to(box, p) > tracker.limit) return;
    const Vec3d size = box.size();
    const double most = std::max({size.x, size.y, size.z});
    if (most <= 2 * piece) return ask(box);
    if (most > worth_asking * piece && empty(box)) return;
    const Vec3d c = box.center();
    std::array<Box3d, 8> parts;
    for (unsigned i = 0; i < 8; ++i)
      parts[i] = {{i & 1 ? c.x : box.lo.x, i & 2 ? c.y : box.lo.y, i & 4 ? c.z : box.lo.z},
                  {i & 1 ? box.hi.x : c.x, i & 2 ? box.hi.y : c.y, i & 4 ? box.hi.z : c.z}};
    std::sort(parts.begin(), parts.end(),
              [&](const Box3d& a, const Box3d& b) { return distance_to(a, p) < distance_to(b, p); });
    for (const Box3d& part : parts) self(self, part);
  };
  // Near first: most searches end there.
  for (double size = std::min(tracker.limit, piece / 4);; size = std::min(4 * size, tracker.limit)) {
    const Box3d box = common(Box3d{p, p}.grown(size), everything);
    if (!box.empty()) search(search, box);
    const bool all = box.lo == everything.lo && box.hi == everything.hi;
    if (all || size >= tracker.limit) return;
  }
}

std::optional<RayHit> Collider::ray(Vec3d from, Vec3d direction, double distance) const {
  check(from, "the ray's origin");
  check(direction, "the ray's direction");
  check_distance(distance);
  const double most = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  if (!(most > 0)) fail(ErrorKind::usage, "the ray has no direction");
  if (most < 1 / immense) direction = {direction.x / most, direction.y / most, direction.z / most};
  // A way without end cannot be measured in shares of itself.
  const Vec3d unit = direction * (1 / length(direction));
  const double end = std::min(distance, farthest);
  struct Search {
    Vec3d from, along;
    double best = infinity;
    Vec3d normal;
    double look(const Triangle& triangle, double) {
      const auto hit = impl::ray_hit(triangle, from, along);
      if (hit && *hit <= 1 && *hit < best) best = *hit, normal = triangle.cross();
      return best;
    }
  } search{from, unit * end, infinity, {}};
  search_along(from, search.along, {}, 0, &look<Search>, &search);
  if (search.best > 1) return {};
  return RayHit{search.best * end, from + search.along * search.best, normalized(search.normal),
                dot(search.normal, unit) > 0};
}

Vec3d Collider::normal_at(Vec3d q) const {
  struct Search {
    Vec3d at, normal;
    double look(const Triangle& triangle, double distance) {
      if (length(impl::nearest_point(triangle, at) - at) <= impl::meeting)
        normal += normalized(triangle.cross()) * impl::angle_at(triangle, at, impl::meeting);
      return distance;
    }
  } search{q, {}};
  search_around(q, impl::meeting, &look<Search>, &search);
  return normalized(search.normal);
}

std::optional<ClosestPoint> Collider::closest(Vec3d p, double distance) const {
  check(p, "the point");
  check_distance(distance);
  struct Search {
    Vec3d from, point;
    double best;
    bool found = false;
    double look(const Triangle& triangle, double) {
      const Vec3d q = impl::nearest_point(triangle, from);
      const double d = length(q - from);
      if (d <= best && (!found || d < best)) best = d, point = q, found = true;
      return best;
    }
  } search{p, {}, distance};
  search_around(p, distance, &look<Search>, &search);
  if (!search.found) return {};
  // The sign of the distance by the weighted normal is right at edges and corners, too
  // [Baerentzen05].
  const Vec3d normal = normal_at(search.point);
  const bool rock = dot(p - search.point, normal) < 0;
  return ClosestPoint{search.point, normal, rock ? -search.best : search.best};
}

bool Collider::solid(Vec3d p) const {
  check(p, "the point");
  const Side known = side(p);
  if (known != Side::unknown) return known == Side::rock;
  const auto near = closest(p, reach());
  return near && near->distance < 0;
}

bool Collider::overlaps(const Capsule& shape) const {
  check(shape);
  struct Search {
    const Capsule& own;
    bool found = false;
    double look(const Triangle& triangle, double end) {
      const double most = std::max(0.0, own.radius - impl::touching);
      const impl::NearestPair pair = impl::nearest_pair(triangle, own.a, own.b);
      found =
          pair.squared < most * most || (pair.squared == 0 && depth_of(triangle, own, pair) > impl::touching);
      return found ? -1 : end;
    }
  } search{shape};
  const Vec3d half = (shape.b - shape.a) * 0.5;
  search_along(shape.a + half, {}, half, shape.radius, &look<Search>, &search);
  return search.found || solid(shape.a);
}

/// The way out of rock in which the whole shape lies.
std::optional<Contact> Collider::buried(const Capsule& shape) const {
  const double far = stride() == infinity ? infinity : deep_search * stride();
  const auto near = closest(shape.a, far);
  if (!near) return Contact{shape.a, {0, 0, 1}, infinity};
  const Vec3d out = near->distance < 0 ? normalized(near->point - shape.a) : near->normal;
  const double deeper = std::max(0.0, -dot(shape.b - shape.a, out));
  return Contact{near->point, out, std::abs(near->distance) + shape.radius + deeper};
}

std::optional<Contact> Collider::contact(const Capsule& shape) const {
  check(shape);
  struct Search {
    const Capsule& own;
    impl::NearestPair nearest;
    double crossing = infinity;  ///< least depth among triangles that cross the axis
    Vec3d point, normal;
    double look(const Triangle& triangle, double end) {
      const impl::NearestPair pair = impl::nearest_pair(triangle, own.a, own.b);
      if (pair.squared < nearest.squared) nearest = pair;
      if (pair.squared > 0) return end;
      const double depth = depth_of(triangle, own, pair);
      if (depth < crossing) crossing = depth, point = pair.on_triangle, normal = normalized(triangle.cross());
      return end;
    }
  } search{shape, {{}, {}, infinity}, infinity, {}, {}};
  const Vec3d half = (shape.b - shape.a) * 0.5;
  search_along(shape.a + half, {}, half, shape.radius, &look<Search>, &search);
  if (search.crossing < infinity) return Contact{search.point, search.normal, search.crossing};
  const double gap = std::sqrt(search.nearest.squared);
  if (!(gap < shape.radius - impl::touching)) return solid(shape.a) ? buried(shape) : std::nullopt;
  const Vec3d away = (search.nearest.on_segment - search.nearest.on_triangle) * (1 / gap);
  if (dot(away, normal_at(search.nearest.on_triangle)) >= 0)
    return Contact{search.nearest.on_triangle, away, shape.radius - gap};
  const Vec3d q = search.nearest.on_triangle;
  const double below = std::max(dot(shape.a - q, away), dot(shape.b - q, away));
  return Contact{q, -away, shape.radius + below};
}

std::optional<SweepHit> Collider::sweep(const Capsule& shape, Vec3d motion) const {
  check(shape);
  check(motion, "the motion");
  struct Search {
    const Capsule& own;
    Vec3d way;
    impl::MovingHit best{infinity, {}, {}};
    Vec3d face;
    bool overlap = false;
    double look(const Triangle& triangle, double) {
      const double most = std::min(best.time, 1.0);
      const auto hit = impl::moving_hit(triangle, own.a, own.b, own.radius, way, most);
      if (hit && hit->overlap) {
        overlap = true;
        return -1.0;
      }
      if (hit && hit->time < best.time) best = *hit, face = triangle.cross();
      return best.time;
    }
  } search{shape, motion, {infinity, {}, {}}, {}};
  const Vec3d half = (shape.b - shape.a) * 0.5;
  search_along(shape.a + half, motion, half, shape.radius, &look<Search>, &search);
  const bool hit = search.best.time <= 1;
  bool rock = search.overlap;
  if (!rock) {
    // A contact on a face's inside has that face's side of the rock; only at edges and corners it may not
    // tell.
    const double facing = dot(search.face, search.best.normal);
    const bool certain = hit && std::abs(facing) > 0.999999 * length(search.face);
    rock = certain ? facing < 0 : solid(shape.a);
  }
  if (rock) {
    const auto deep = contact(shape);
    if (deep) return SweepHit{0, deep->point, deep->normal, deep->depth};
  }
  if (!hit) return {};
  return SweepHit{search.best.time, search.best.point, search.best.normal, 0};
}

void Collider::rays(std::span<const Ray> queries, std::span<std::optional<RayHit>> out) const {
  if (out.size() != queries.size()) fail(ErrorKind::internal, "rays() wants one result a query");
  parallel_blocks(std::ssize(queries), 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      out[i] = ray(queries[i].from, queries[i].direction, queries[i].distance);
  });
}

void Collider::sweeps(std::span<const Motion> queries, std::span<std::optional<SweepHit>> out) const {
  if (out.size() != queries.size()) fail(ErrorKind::internal, "sweeps() wants one result a query");
  parallel_blocks(std::ssize(queries), 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) out[i] = sweep(queries[i].shape, queries[i].motion);
  });
}

}  // namespace tafoni::query
