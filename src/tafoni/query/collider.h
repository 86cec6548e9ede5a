#pragma once
// Collision queries with one interface, against compiled fields, volumes and meshes.
//
// The surface that is met is the one that is seen. A provider tells which triangles of its mesh lie near a
// place, and on which side of them a point lies; every query is written once over these, so that its cost
// follows what is near. Contacts with faces, edges and corners are exact to rounding: shapes nearer than
// 1e-6 m to touching count as touching, and nothing passes through a surface at any speed.
//
// Positions are local metres. Normals point from the rock to the air where they belong to the surface, and
// from the surface to the shape where they belong to a contact. Queries may be asked from any number of
// threads. Those that get a number that is not finite, a shape without radius or a ray without direction
// throw Error{usage}; motions, distances and capsules of no length are like any other.

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::query {

namespace impl {
class TriangleTree;

struct Triangle;
}  // namespace impl

struct Sphere {
  Vec3d center;
  double radius = 0;
};

/// All within `radius` of the segment from a to b. A sphere is one whose ends are the same.
struct Capsule {
  Vec3d a, b;
  double radius = 0;

  Capsule(Vec3d from, Vec3d to, double r) : a(from), b(to), radius(r) {}
  Capsule(const Sphere& s) : a(s.center), b(s.center), radius(s.radius) {}  // NOLINT: a sphere is one
  Capsule moved(Vec3d by) const { return {a + by, b + by, radius}; }
};

struct RayHit {
  double distance = 0;  ///< metres from where the ray begins
  Vec3d point, normal;  ///< of the surface
  bool from_rock = false;
};

struct ClosestPoint {
  Vec3d point, normal;  ///< on edges and corners, the mean of the faces that meet there, by their angles
  double distance = 0;  ///< metres, below 0 for a point in the rock
};

/// How a shape overlaps rock: moving it by normal * depth frees it where this is all that it touches.
struct Contact {
  Vec3d point, normal;
  double depth = 0;
};

struct SweepHit {
  double time = 0;  ///< share of the motion before the contact
  Vec3d point, normal;
  double depth = 0;  ///< above 0 when the shape overlaps rock before it moves: time is 0, see Contact
};

struct SlideSettings {
  int iterations = 5;   ///< surfaces to slide along in one motion
  double skin = 0.005;  ///< metres kept between the shape and the surface that it runs into
  /// Surfaces that rise more steeply count as upright, so that nothing climbs them: those whose normal's z is
  /// below this. -1: none.
  double wall = -1;
};

struct Slide {
  Vec3d moved;                 ///< by how much the shape may move; it overlaps nothing there unless `stuck`
  std::vector<SweepHit> hits;  ///< in order
  bool freed = false;          ///< it overlapped rock and was pushed out before it went on
  bool stuck = false;          ///< it overlapped rock and no way out was found: it stays where it is
};

class Collider {
 public:
  virtual ~Collider() = default;

  /// A box that holds the whole surface; empty where there is none.
  virtual Box3d bounds() const = 0;

  /// Where the ray first crosses the surface, from the air or from the rock, within `distance` metres.
  std::optional<RayHit> ray(Vec3d from, Vec3d direction, double distance) const;
  /// Whether the point lies in the rock.
  bool solid(Vec3d p) const;
  /// The surface's point nearest to p, if one lies within `distance` metres, which may be infinite.
  std::optional<ClosestPoint> closest(Vec3d p, double distance) const;
  /// Whether some of the shape lies in rock, by more than touching.
  bool overlaps(const Capsule& shape) const;
  /// The same with a way out. In rock with no surface within reach of a search, that is up and of unknown
  /// depth (infinite).
  std::optional<Contact> contact(const Capsule& shape) const;
  /// The first contact of the moving shape.
  std::optional<SweepHit> sweep(const Capsule& shape, Vec3d motion) const;
  /// Moves the shape as far as it goes, along the surfaces that it meets. First frees it where it overlaps.
  Slide slide(const Capsule& shape, Vec3d motion, const SlideSettings& settings = {}) const;

  /// Many at once, on all threads; results in the order given, the same as one by one.
  struct Ray {
    Vec3d from, direction;
    double distance = 0;
  };
  struct Motion {
    Capsule shape;
    Vec3d motion;
  };
  void rays(std::span<const Ray> queries, std::span<std::optional<RayHit>> out) const;
  void sweeps(std::span<const Motion> queries, std::span<std::optional<SweepHit>> out) const;

 protected:
  enum class Side { air, rock, unknown };
  using TreeVisitor = std::function<void(const impl::TriangleTree&)>;

  /// Shows every tree that may have triangles in the box.
  virtual void visit(const Box3d& box, const TreeVisitor& visitor) const = 0;
  /// The side of a point that is cheap to tell; else unknown, and then the surface lies within reach().
  virtual Side side(Vec3d p) const = 0;
  virtual double reach() const = 0;
  /// Metres: long ways are searched in pieces about so long. Infinite where all is one tree.
  virtual double stride() const = 0;
  /// True where the box holds no surface for certain and that is cheap to tell; asked for large boxes only.
  virtual bool empty(const Box3d& box) const = 0;

 private:
  using Found = double (*)(void*, const impl::Triangle&, double);
  void search_along(Vec3d from, Vec3d along, Vec3d half, double radius, Found found, void* context) const;
  void search_around(Vec3d p, double distance, Found found, void* context) const;
  Vec3d normal_at(Vec3d q) const;
  std::optional<Contact> buried(const Capsule& shape) const;
  bool free(const Capsule& shape, Vec3d& at, double skin) const;
};

}  // namespace tafoni::query
