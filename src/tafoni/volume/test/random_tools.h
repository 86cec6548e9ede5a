#pragma once
// Tools of every shape at random, from smaller than a cell to larger than the room.

#include <cmath>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/volume/tool.h"

namespace tafoni::volume {

inline Vec3d random_point(Random& r, const Box3d& room) {
  const double x = r.uniform(room.lo.x, room.hi.x), y = r.uniform(room.lo.y, room.hi.y);
  return {x, y, r.uniform(room.lo.z, room.hi.z)};
}

/// Small ones are more frequent.
inline Tool random_tool(Random& r, const Box3d& room) {
  const Vec3d extent = room.size(), c = random_point(r, room.grown(0.5));
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double size = longest * std::exp(r.uniform(std::log(0.01), std::log(0.25)));
  const double big = r.uniform() < 0.002 ? 2 * longest : size;
  switch (r.below(4)) {
    case 0:
      return Tool::sphere(c, big);
    case 1: {
      const Vec3d to = c + (random_point(r, room) - c) * r.uniform();
      return Tool::capsule(c, r.below(8) ? to : Vec3d{c.x, c.y, to.z}, 0.5 * size);
    }
    case 2: {
      const double x = r.uniform(0.2, 1), y = r.uniform(0.2, 1);
      return Tool::box(c, Vec3d{x, y, r.uniform(0.2, 1)} * big, r.below(2) ? r.uniform(0, 7) : 0);
    }
    default: {
      std::vector<Vec3d> points;
      for (std::uint64_t n = 4 + r.below(9); n > 0; --n)
        points.push_back(c + random_point(r, {{-1, -1, -1}, {1, 1, 1}}) * size);
      return Tool::hull(points);
    }
  }
}

}  // namespace tafoni::volume
