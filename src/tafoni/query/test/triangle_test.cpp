#include "tafoni/query/impl/triangle.h"

#include <gtest/gtest.h>

#include "tafoni/query/test/meshes.h"

namespace tafoni::query::impl {
namespace {

using testing::random_point;

Triangle random_triangle(Random& random) {
  const Vec3d at = random_point(random, 1);
  const double size = std::exp(random.uniform(-3, 1));
  return {
      {at + random_point(random, size), at + random_point(random, size), at + random_point(random, size)}};
}

double distance(const Triangle& t, Vec3d p) {
  return length(nearest_point(t, p) - p);
}

TEST(Triangle, NearestPointIsNearerThanAnySample) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3d p = random_point(random, 3);
    const Vec3d q = nearest_point(t, p);
    // In the triangle: the three areas around q add up to the whole.
    double areas = 0;
    for (int c = 0; c < 3; ++c) areas += length(cross(t.v[c] - q, t.v[(c + 1) % 3] - q));
    EXPECT_NEAR(areas, length(t.cross()), 1e-9);
    constexpr int n = 24;
    for (int a = 0; a <= n; ++a)
      for (int b = 0; a + b <= n; ++b) {
        const Vec3d s = t.v[0] + (t.v[1] - t.v[0]) * (a / double{n}) + (t.v[2] - t.v[0]) * (b / double{n});
        EXPECT_GE(length(s - p), length(q - p) - 1e-12);
      }
  }
}

TEST(Triangle, NearestPairIsTheLeastAlongTheSegment) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3d a = random_point(random, 2), b = random_point(random, 2);
    // Distance to a convex set is convex along a line.
    double lo = 0, hi = 1;
    for (int k = 0; k < 100; ++k) {
      const double s = lo + (hi - lo) / 3, u = hi - (hi - lo) / 3;
      (distance(t, a + (b - a) * s) < distance(t, a + (b - a) * u) ? hi : lo) =
          distance(t, a + (b - a) * s) < distance(t, a + (b - a) * u) ? u : s;
    }
    const NearestPair pair = nearest_pair(t, a, b);
    EXPECT_NEAR(std::sqrt(pair.squared), distance(t, a + (b - a) * lo), 1e-7);
    EXPECT_NEAR(length(pair.on_segment - pair.on_triangle), std::sqrt(pair.squared), 1e-12);
    EXPECT_NEAR(distance(t, pair.on_triangle), 0, 1e-12);
  }
}

/// The first time at which the shape is within its radius: steps of the distance that is left never go too
/// far.
double first_touch(const Triangle& t, Vec3d a, Vec3d b, double radius, Vec3d motion) {
  const double size = length(motion);
  double time = 0;
  for (int k = 0; k < 100000 && time <= 1; ++k) {
    const Vec3d moved = motion * time;
    const double left = std::sqrt(nearest_pair(t, a + moved, b + moved).squared) - radius;
    if (left < 1e-8) return time;
    time += left / size;
  }
  return 2;
}

TEST(Triangle, MovingShapesTouchWhenTheDistanceSaysSo) {
  Random random(3);
  int hits = 0, misses = 0;
  for (int i = 0; i < 4000; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3d a = random_point(random, 3), b = i % 2 ? a : a + random_point(random, 1);
    const double radius = std::exp(random.uniform(-4, 0));
    const Vec3d motion = (t.v[0] + random_point(random, 1) - a) * 2;
    if (nearest_pair(t, a, b).squared < (radius + 1e-3) * (radius + 1e-3)) continue;
    const double truth = first_touch(t, a, b, radius, motion);
    const auto hit = moving_hit(t, a, b, radius, motion);
    const double time = hit ? hit->time : 2;
    if (std::abs(time - truth) > 1e-4) {
      // Only a graze may be seen by one and not by the other.
      double least = 1e9;
      for (int k = 0; k <= 20000; ++k) {
        const Vec3d moved = motion * (k / 20000.0);
        least = std::min(least, std::sqrt(nearest_pair(t, a + moved, b + moved).squared) - radius);
      }
      EXPECT_NEAR(least, 0, 1e-5) << i << " " << time << " " << truth;
      continue;
    }
    if (!hit) {
      ++misses;
      continue;
    }
    ++hits;
    const Vec3d moved = motion * hit->time;
    const NearestPair pair = nearest_pair(t, a + moved, b + moved);
    EXPECT_NEAR(std::sqrt(pair.squared), radius, 1e-9);
    EXPECT_NEAR(length(hit->normal), 1, 1e-12);
    EXPECT_LE(dot(hit->normal, motion), 0);
    EXPECT_NEAR(distance(t, hit->point), 0, 1e-9);
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 500);
}

TEST(Triangle, ACapsuleOfNoLengthIsASphere) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3d a = random_point(random, 3), motion = random_point(random, 1) * 2 - a;
    const double radius = random.uniform(0.01, 0.3);
    const auto sphere = moving_hit(t, a, a, radius, motion);
    const auto capsule = moving_hit(t, a, a + Vec3d{0, 0, 1e-13}, radius, motion);
    ASSERT_EQ(sphere.has_value(), capsule.has_value());
    if (!sphere) continue;
    EXPECT_NEAR(sphere->time, capsule->time, 1e-9);
  }
}

TEST(Triangle, TouchingShapesMoveAlongAndAwayButNotIn) {
  const Triangle t{{{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}}};
  const Vec3d at{0, 0, 1};
  EXPECT_FALSE(moving_hit(t, at, at, 1, {1, 0, 0}));
  EXPECT_FALSE(moving_hit(t, at, at, 1, {0, 0, 1}));
  EXPECT_FALSE(moving_hit(t, at, at, 1, {0, 0, 0}));
  const auto in = moving_hit(t, at, at, 1, {0, 0, -1});
  ASSERT_TRUE(in);
  EXPECT_EQ(in->time, 0);
  EXPECT_TRUE(moving_hit(t, at, at, 1.1, {0, 0, 1})->overlap);
}

TEST(Triangle, RaysLeaveNoGapBetweenNeighbours) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const Vec3d a = random_point(random, 1), b = random_point(random, 1);
    const Vec3d c = random_point(random, 1), d = a + b - c + random_point(random, 0.1);
    const Triangle left{{a, b, c}}, right{{b, a, d}};
    const Vec3d from = random_point(random, 4);
    const Vec3d to = a + (b - a) * random.uniform();  // on the edge, as far as doubles can be
    // Seen edge on, the pair is a line; rays may pass on either side of a ridge seen from its side.
    const double s = dot(cross(a - from, b - from), c - from), r = dot(cross(a - from, b - from), d - from);
    if (!(s * r < 0)) continue;
    EXPECT_TRUE(ray_hit(left, from, to - from) || ray_hit(right, from, to - from));
  }
}

TEST(Triangle, AnglesOfCornersEdgesAndFaces) {
  const Triangle t{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  EXPECT_NEAR(angle_at(t, {0, 0, 0}, 1e-7), 0.25, 1e-12);
  EXPECT_NEAR(angle_at(t, {1, 0, 0}, 1e-7), 0.125, 1e-12);
  EXPECT_EQ(angle_at(t, {0.5, 0, 0}, 1e-7), 0.5);
  EXPECT_EQ(angle_at(t, {0.25, 0.25, 0}, 1e-7), 1);
}

}  // namespace
}  // namespace tafoni::query::impl
