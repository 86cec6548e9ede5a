#include "tafoni/io/impl/polygon.h"

#include <cmath>

namespace tafoni::io::impl {
namespace {

/// A look at a corner goes over all others, and without a limit a polygon could ask for as many looks at each
/// as it has corners.
constexpr std::size_t looks_a_corner = 32;

/// Twice the area, positive where a, b, c turn left.
double turn(Vec2d a, Vec2d b, Vec2d c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Along the normal, as long as twice the area.
Vec3d area_vector(std::span<const Vec3d> corners) {
  Vec3d sum;
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum += cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  return sum;
}

/// Drops the axis along which the normal is longest; what turned left about the normal still does.
Vec2d flattened(Vec3d p, Vec3d normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  if (z >= x && z >= y) return normal.z > 0 ? Vec2d{p.x, p.y} : Vec2d{p.y, p.x};
  if (y >= x) return normal.y > 0 ? Vec2d{p.z, p.x} : Vec2d{p.x, p.z};
  return normal.x > 0 ? Vec2d{p.y, p.z} : Vec2d{p.z, p.y};
}

}  // namespace

std::span<const std::array<std::uint32_t, 3>> PolygonCutter::cut(std::span<const std::uint32_t> polygon,
                                                                 std::span<const Vec3d> positions) {
  triangles_.clear();
  if (polygon.size() > 3 && polygon.size() <= most_corners && look_at(polygon, positions)) {
    if (cut_ears()) return triangles_;
    triangles_.clear();
  }
  for (std::uint32_t i = 2; i < polygon.size(); ++i) triangles_.push_back({0, i - 1, i});
  return triangles_;
}

/// Whether ears are to be cut off: corners are known, and a fan would fold over.
bool PolygonCutter::look_at(std::span<const std::uint32_t> polygon, std::span<const Vec3d> positions) {
  corners_.clear();
  for (const std::uint32_t v : polygon) {
    if (v >= positions.size()) return false;
    corners_.push_back(positions[v]);
  }
  const Vec3d normal = area_vector(corners_);
  if (fan_covers(normal)) return false;
  flat_.clear();
  for (const Vec3d& p : corners_) flat_.push_back(flattened(p - corners_[0], normal));
  return true;
}

bool PolygonCutter::fan_covers(Vec3d normal) const {
  for (std::size_t i = 2; i < corners_.size(); ++i)
    if (dot(cross(corners_[i - 1] - corners_[0], corners_[i] - corners_[0]), normal) < 0) return false;
  return true;
}

/// Whether the corner turns left and no other lies in its triangle.
bool PolygonCutter::is_ear(std::size_t at) const {
  const std::size_t n = left_.size();
  const Vec2d a = flat_[left_[(at + n - 1) % n]], b = flat_[left_[at]], c = flat_[left_[(at + 1) % n]];
  if (!(turn(a, b, c) > 0)) return false;
  for (std::size_t k = 2; k + 1 < n; ++k) {
    const Vec2d p = flat_[left_[(at + k) % n]];
    if (p == a || p == b || p == c) continue;
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

bool PolygonCutter::cut_ears() {
  left_.resize(flat_.size());
  for (std::uint32_t i = 0; i < left_.size(); ++i) left_[i] = i;
  std::size_t at = 0, looks = 0;
  for (std::size_t failures = 0; left_.size() > 3; ++looks) {
    const std::size_t n = left_.size();
    at %= n;
    const std::uint32_t before = left_[(at + n - 1) % n], after = left_[(at + 1) % n];
    // Corners on a straight line are cut off last, unless nothing else is left.
    const bool flat = turn(flat_[before], flat_[left_[at]], flat_[after]) == 0;
    if (is_ear(at) || (flat && failures >= n)) {
      triangles_.push_back({before, left_[at], after});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
      failures = 0;
    } else if (++failures > 2 * n || looks > looks_a_corner * flat_.size()) {
      return false;
    } else {
      ++at;
    }
  }
  triangles_.push_back({left_[0], left_[1], left_[2]});
  return true;
}

}  // namespace tafoni::io::impl
