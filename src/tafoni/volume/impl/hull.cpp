// The convex hull by adding point after point. Points are rounded to 2^-38 of their extent, so that which
// side of a plane a point lies on is decided exactly, in 128 bits: no tolerance can break the surface.

#include <array>
#include <cstdint>
#include <set>

#include "tafoni/core/error.h"
#include "tafoni/volume/impl/tool_shape.h"

namespace tafoni::volume::impl {

namespace {

using Whole = Vec3<std::int64_t>;
using Wide = __int128;
using WideVec = Vec3<Wide>;

constexpr int extent_bits = 38;
/// Parts of the extent: points that leave a line or a plane by less are flat.
constexpr double flat_share = 1e-9;

WideVec wide(Whole a) {
  return {a.x, a.y, a.z};
}

struct Face {
  std::array<int, 3> at;  ///< counter-clockwise from outside
  WideVec normal;         ///< below 2^79
};

class Builder {
 public:
  explicit Builder(std::span<const Vec3d> points) : points_(points) {
    Box3d box;
    for (Vec3d p : points) box.expand(p);
    const Vec3d size = points.empty() ? Vec3d{} : box.size();
    const double extent = std::max({size.x, size.y, size.z});
    if (points.size() < 4 || !(extent > 0)) flat();
    const double scale = std::ldexp(1.0, extent_bits) / extent;
    for (Vec3d p : points) {
      const Vec3d d = (p - box.lo) * scale;
      at_.push_back({std::llround(d.x), std::llround(d.y), std::llround(d.z)});
    }
    first_tetrahedron(extent);
    for (int i = 0; i < std::ssize(points); ++i) add(i);
  }

  Hull hull() const {
    Hull out;
    std::set<int> used;
    for (const Face& f : faces_) used.insert(f.at.begin(), f.at.end());
    for (int i : used) out.corners.push_back(points_[i]);
    // Triangles of one exact plane are one plane. Its offset holds every corner, rounding included.
    std::set<std::array<double, 3>> seen;
    for (const Face& f : faces_) {
      const Vec3d n = normalized(Vec3d{static_cast<double>(f.normal.x), static_cast<double>(f.normal.y),
                                       static_cast<double>(f.normal.z)});
      if (!seen.insert({n.x, n.y, n.z}).second) continue;
      double offset = -std::numeric_limits<double>::infinity();
      for (Vec3d c : out.corners) offset = std::max(offset, dot(n, c));
      (n.z > 0 ? out.upper : n.z < 0 ? out.lower : out.walls).push_back({n, offset});
    }
    return out;
  }

 private:
  [[noreturn]] static void flat() {
    fail(ErrorKind::usage, "the points of a hull lie in a plane; give four or more that do not");
  }

  Whole point(int i) const { return at_[i]; }

  WideVec normal(int a, int b, int c) const {
    return cross(wide(point(b) - point(a)), wide(point(c) - point(a)));
  }
  bool outside(const Face& f, int p) const { return dot(f.normal, wide(point(p) - point(f.at[0]))) > 0; }

  void first_tetrahedron(double extent) {
    const auto furthest = [&](auto measure) {
      int best = 0;
      for (int i = 1; i < std::ssize(points_); ++i)
        if (measure(points_[i]) > measure(points_[best])) best = i;
      return best;
    };
    const Vec3d a = points_[0];
    const int ib = furthest([&](Vec3d p) { return length(p - a); });
    const Vec3d along = normalized(points_[ib] - a);
    const int ic = furthest([&](Vec3d p) { return length(cross(along, p - a)); });
    const Vec3d up = normalized(cross(along, points_[ic] - a));
    const int id = furthest([&](Vec3d p) { return std::abs(dot(up, p - a)); });
    if (!(length(cross(along, points_[ic] - a)) > flat_share * extent) ||
        !(std::abs(dot(up, points_[id] - a)) > flat_share * extent))
      flat();
    std::array<int, 4> t{0, ib, ic, id};
    if (dot(normal(t[0], t[1], t[2]), wide(point(t[3]) - point(t[0]))) > 0) std::swap(t[1], t[2]);
    for (auto [i, j, k] : {std::array{t[0], t[1], t[2]}, std::array{t[0], t[3], t[1]},
                           std::array{t[1], t[3], t[2]}, std::array{t[2], t[3], t[0]}})
      faces_.push_back({{i, j, k}, normal(i, j, k)});
  }

  /// The faces that see the point go; their rim and the point make new ones. A face in whose plane the point
  /// lies stays, and no edge of the rim is in line with the point, so that no face is without area.
  void add(int p) {
    std::set<std::pair<int, int>> edges;
    std::vector<Face> kept;
    for (const Face& f : faces_) {
      if (!outside(f, p)) {
        kept.push_back(f);
        continue;
      }
      for (int i = 0; i < 3; ++i) edges.emplace(f.at[i], f.at[(i + 1) % 3]);
    }
    if (edges.empty()) return;
    for (auto [a, b] : edges)
      if (!edges.contains({b, a})) kept.push_back({{a, b, p}, normal(a, b, p)});
    faces_ = std::move(kept);
  }

  std::span<const Vec3d> points_;
  std::vector<Whole> at_;
  std::vector<Face> faces_;
};

}  // namespace

Hull convex_hull(std::span<const Vec3d> points) {
  return Builder(points).hull();
}

}  // namespace tafoni::volume::impl
