#pragma once
// Random edits for tests.

#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/runtime/operation.h"

namespace tafoni::runtime {

/// Of every kind, somewhere in the box, with radii up to `most`.
inline Operation random_operation(std::uint64_t index, const Box3d& box, double most) {
  using volume::Edit;
  using volume::Tool;
  Random r(77, index);
  const auto place = [&](Vec3d about, double reach) {
    const double x = r.uniform(-reach, reach), y = r.uniform(-reach, reach);
    return about + Vec3d{x, y, r.uniform(-reach, reach)};
  };
  const Vec3d size = box.size() * 0.5, middle = box.center();
  const double x = r.uniform(-size.x, size.x), y = r.uniform(-size.y, size.y);
  const Vec3d at = middle + Vec3d{x, y, r.uniform(-size.z, size.z)};
  const double radius = r.uniform(0.2 * most, most);
  const Edit edit = r.below(3) == 0 ? Edit::add : Edit::remove;
  switch (r.below(6)) {
    case 0:
      return ToolUse{Tool::sphere(at, radius), edit};
    case 1:
      return ToolUse{Tool::capsule(at, place(at, most), 0.5 * radius), edit};
    case 2: {
      const double a = r.uniform(0.2, 1), b = r.uniform(0.2, 1);
      return ToolUse{Tool::box(at, Vec3d{a, b, r.uniform(0.2, 1)} * (0.6 * radius), r.uniform(-4, 4)), edit};
    }
    case 3: {
      std::vector<Vec3d> points;
      for (std::uint64_t n = 5 + r.below(12); n > 0; --n) points.push_back(place(at, 0.6 * most));
      return ToolUse{Tool::hull(points), edit};
    }
    case 4:
      return Explosion{at, radius, r.uniform(-2, 5)};
    default:
      return Radial{at, radius, {r.uniform(-4, 2), r.uniform(-4, 4), 0}};
  }
}

}  // namespace tafoni::runtime
