// Chooses an origin by the box of the positions that triangles use, takes it off in double, and rounds only
// then.

#include "tafoni/io/impl/placing.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace tafoni::io::impl {
namespace {

/// How many of its own lengths a mesh may lie from zero. Floats about zero are then as good as about its
/// middle, but for four bits of 24.
constexpr double near_zero = 16;

bool finite(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Box3d used_box(const mesh::Mesh& mesh, std::span<const Vec3d> given) {
  Box3d box;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (v < given.size() && finite(given[v])) box.expand(given[v]);
  return box;
}

/// Whether a number is a float's, in binary or as the shortest text that reads back to it.
bool is_float(double number) {
  const auto rounded = static_cast<float>(number);
  if (rounded == number) return true;
  char text[32];
  const char* const end = std::to_chars(text, text + sizeof text, rounded).ptr;
  double back = 0;
  std::from_chars(text, end, back);
  return back == number;
}

bool are_floats(std::span<const Vec3d> given) {
  return std::all_of(given.begin(), given.end(),
                     [](Vec3d p) { return is_float(p.x) && is_float(p.y) && is_float(p.z); });
}

/// What to take off the positions: zero, or the middle of the box in steps of a power of two that is no more
/// than its side, along each axis that needs it.
Vec3d offset_of(const Box3d& box) {
  if (box.empty()) return {};
  const Vec3d size = box.size();
  const double side = std::max({size.x, size.y, size.z});
  // Beyond this, floats do not reach from one end to the other; check_read() names the vertex.
  if (!(side < std::numeric_limits<float>::max() / 4)) return {};
  const double step = side > 0 ? std::exp2(std::floor(std::log2(side))) : 1;
  const auto along = [&](double lo, double hi) {
    if (std::max(std::abs(lo), std::abs(hi)) <= near_zero * side) return 0.0;
    return std::round((lo / 2 + hi / 2) / step) * step;
  };
  return {along(box.lo.x, box.hi.x), along(box.lo.y, box.hi.y), along(box.lo.z, box.hi.z)};
}

}  // namespace

void place(mesh::Mesh& mesh, std::span<const Vec3d> given, const std::optional<Vec3d>& stated) {
  Vec3d offset = offset_of(used_box(mesh, given));
  if (stated && offset != Vec3d{} && are_floats(given)) offset = {};
  mesh.origin = stated.value_or(Vec3d{}) + offset;
  mesh.positions.resize(given.size());
  std::transform(given.begin(), given.end(), mesh.positions.begin(),
                 [&](Vec3d p) { return to_float(p - offset); });
}

void place(mesh::Mesh& mesh, const std::optional<Vec3d>& stated) {
  mesh.origin = stated.value_or(Vec3d{});
  if (stated) return;
  std::vector<Vec3d> given;
  given.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) given.push_back(to_double(p));
  place(mesh, given, stated);
}

}  // namespace tafoni::io::impl
