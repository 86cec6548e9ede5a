#pragma once
// Two colliders that should be the same surface, asked the same.

#include <gtest/gtest.h>

#include "tafoni/query/collider.h"
#include "tafoni/query/test/meshes.h"

namespace tafoni::query::testing {

struct Agreement {
  int rays = 0, sweeps = 0, rocks = 0, overlaps = 0;
};

/// Random queries in and about the box. Distances agree to `tolerance`; who grazes a surface by less may be
/// told otherwise.
inline Agreement expect_agreement(const Collider& a, const Collider& b, const Box3d& box, int count,
                                  double tolerance, std::uint64_t seed) {
  Agreement seen;
  Random random(seed);
  int differ = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3d s = box.size();
    const Vec3d p = box.lo + Vec3d{random.uniform(-0.05, 1.05) * s.x, random.uniform(-0.05, 1.05) * s.y,
                                   random.uniform(-0.05, 1.05) * s.z};
    const Vec3d direction = random_point(random, 1);
    const double far = 0.5 * length(s);
    const auto ray = a.ray(p, direction, far), ray_peer = b.ray(p, direction, far);
    if (ray.has_value() != ray_peer.has_value()) ++differ;
    if (ray && ray_peer) {
      ++seen.rays;
      differ +=
          std::abs(ray->distance - ray_peer->distance) > tolerance || ray->from_rock != ray_peer->from_rock;
    }
    const auto near = a.closest(p, far), near_peer = b.closest(p, far);
    if (near && near_peer) {
      EXPECT_NEAR(std::abs(near->distance), std::abs(near_peer->distance), tolerance);
      if (std::abs(near->distance) > 2 * tolerance) {
        EXPECT_EQ(a.solid(p), b.solid(p)) << p.x << " " << p.y << " " << p.z;
        seen.rocks += a.solid(p);
      }
    } else {
      EXPECT_EQ(near.has_value(), near_peer.has_value());
    }
    const double radius = std::exp(random.uniform(-3, 0));
    const Capsule shape(p, i % 2 ? p : p + Vec3d{0.2, 0, 1}, radius);
    const Vec3d motion = random_point(random, i % 5 ? 3 : far);
    const bool overlap = a.overlaps(shape);
    differ += overlap != b.overlaps(shape);
    seen.overlaps += overlap;
    const auto hit = a.sweep(shape, motion), hit_peer = b.sweep(shape, motion);
    if (hit.has_value() != hit_peer.has_value()) ++differ;
    if (!hit || !hit_peer) continue;
    seen.sweeps += hit->depth == 0;
    differ += std::abs(hit->time - hit_peer->time) * length(motion) > 50 * tolerance;
  }
  EXPECT_LE(differ, tolerance > 1e-9 ? count / 500 : 0);
  EXPECT_GT(seen.rays, count / 20);
  EXPECT_GT(seen.sweeps, count / 50);
  EXPECT_GT(seen.rocks, count / 20);
  EXPECT_GT(seen.overlaps, count / 20);
  return seen;
}

}  // namespace tafoni::query::testing
