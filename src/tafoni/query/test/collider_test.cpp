#include "tafoni/query/collider.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/query/grid_collider.h"
#include "tafoni/query/impl/triangle.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/test/meshes.h"

namespace tafoni::query {
namespace {

using testing::box_mesh;
using testing::random_point;
using testing::sphere_mesh;

impl::Triangle triangle_of(const mesh::Mesh& m, const std::array<std::uint32_t, 3>& t) {
  return {{to_double(m.positions[t[0]]), to_double(m.positions[t[1]]), to_double(m.positions[t[2]])}};
}

TEST(Collider, RaysMatchEveryTriangleOfASoup) {
  const mesh::Mesh m = testing::soup(3000, 10, 1);
  const MeshCollider collider(m);
  Random random(2);
  int hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3d from = random_point(random, 12), direction = random_point(random, 1);
    const double most = random.uniform(1, 60);
    double best = most;
    bool any = false;
    for (const auto& t : m.triangles)
      if (const auto s = impl::ray_hit(triangle_of(m, t), from, normalized(direction)); s && *s <= best)
        best = *s, any = true;
    const auto hit = collider.ray(from, direction, most);
    ASSERT_EQ(hit.has_value(), any) << i;
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(hit->distance, best, 1e-9);
    EXPECT_EQ(dot(hit->normal, direction) > 0, hit->from_rock);
  }
  EXPECT_GT(hits, 200);
}

/// Whether p is behind the nearest triangle, which is what counts as rock in a soup, where nothing is closed.
bool behind_nearest(const mesh::Mesh& m, Vec3d p) {
  double best = std::numeric_limits<double>::infinity();
  bool behind = false;
  for (const auto& t : m.triangles) {
    const impl::Triangle triangle = triangle_of(m, t);
    const Vec3d off = p - impl::nearest_point(triangle, p);
    if (length(off) >= best) continue;
    best = length(off);
    behind = dot(off, triangle.cross()) < 0;
  }
  return behind;
}

TEST(Collider, SweepsMatchEveryTriangleOfASoup) {
  const mesh::Mesh m = testing::soup(1500, 8, 3);
  const MeshCollider collider(m);
  Random random(4);
  int overlaps = 0, buried = 0, hits = 0, free = 0;
  constexpr int count = 1500;
  for (int i = 0; i < count; ++i) {
    const Vec3d a = random_point(random, 12), b = i % 2 ? a : a + random_point(random, 1.5);
    const double radius = std::exp(random.uniform(-4, 0));
    const Vec3d motion = random_point(random, i % 3 ? 8 : 40);
    double best = 2;
    bool overlap = false, at_face = false, from_behind = false;
    for (const auto& t : m.triangles) {
      const auto hit = impl::moving_hit(triangle_of(m, t), a, b, radius, motion);
      if (!hit) continue;
      overlap = overlap || hit->overlap;
      if (hit->time >= best) continue;
      best = hit->time;
      const double facing = dot(normalized(triangle_of(m, t).cross()), hit->normal);
      at_face = std::abs(facing) > 0.999999;
      from_behind = facing < 0;
    }
    // A face that is met from its front shows that the way there is air.
    const bool rock = (best > 1 || !at_face || from_behind) && behind_nearest(m, a);
    const auto hit = collider.sweep(Capsule(a, b, radius), motion);
    ASSERT_EQ(hit.has_value(), overlap || rock || best <= 1) << i;
    if (!hit) {
      ++free;
      continue;
    }
    EXPECT_EQ(hit->depth > 0, overlap || rock) << i;
    ++(overlap ? overlaps : rock ? buried : hits);
    EXPECT_NEAR(hit->time, overlap || rock ? 0 : best, 1e-12);
  }
  // How many there are of each follows from the soup alone; this says that none is too rare to test.
  EXPECT_GT(std::min({overlaps, buried, hits, free}), count / 10);
}

TEST(Collider, NearestPointsMatchEveryTriangleOfASoup) {
  const mesh::Mesh m = testing::soup(3000, 20, 5);
  const MeshCollider collider(m);
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p = random_point(random, 30);
    double best = 1e9;
    for (const auto& t : m.triangles)
      best = std::min(best, length(impl::nearest_point(triangle_of(m, t), p) - p));
    const auto near = collider.closest(p, std::numeric_limits<double>::infinity());
    ASSERT_TRUE(near);
    EXPECT_NEAR(std::abs(near->distance), best, 1e-12);
    EXPECT_FALSE(collider.closest(p, best * 0.999));
    EXPECT_TRUE(collider.closest(p, best * 1.001));
  }
}

/// Metres inside a box (below 0) or outside.
double box_distance(Vec3d p, Vec3d half) {
  const Vec3d q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const Vec3d out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return length(out) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

TEST(Collider, ABoxIsKnownExactly) {
  const Vec3d half{2, 3, 1};
  const MeshCollider collider(box_mesh(-half, half));
  Random random(7);
  for (int i = 0; i < 3000; ++i) {
    const Vec3d p = random_point(random, 5);
    const double truth = box_distance(p, half);
    const auto near = collider.closest(p, 100);
    ASSERT_TRUE(near);
    EXPECT_NEAR(near->distance, truth, 1e-9);
    EXPECT_EQ(collider.solid(p), truth < 0);
    const double radius = random.uniform(0.05, 1.5);
    EXPECT_EQ(collider.overlaps(Sphere{p, radius}), truth < radius);
    const auto contact = collider.contact(Sphere{p, radius});
    ASSERT_EQ(contact.has_value(), truth < radius);
    if (!contact) continue;
    EXPECT_NEAR(contact->depth, radius - truth, 1e-9);
    EXPECT_GE(box_distance(p + contact->normal * contact->depth, half), radius - 1e-9);
  }
}

TEST(Collider, ASphereIsKnownToItsFacets) {
  const double radius = 5;
  const mesh::Mesh m = sphere_mesh({1, 2, 3}, radius, 5);
  const MeshCollider collider(m);
  double facet = 0;  // how far the facets lie within the sphere
  for (const auto& t : m.triangles) {
    const impl::Triangle c = triangle_of(m, t);
    facet = std::max(facet, radius - length((c.v[0] + c.v[1] + c.v[2]) * (1 / 3.0) - Vec3d{1, 2, 3}));
  }
  Random random(8);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d from = Vec3d{1, 2, 3} + normalized(random_point(random, 1)) * random.uniform(7, 30);
    const Vec3d motion = Vec3d{1, 2, 3} + random_point(random, 5) - from;
    const double r = random.uniform(0.1, 1.5);
    // |from + t motion - center| = radius + r
    const Vec3d o = from - Vec3d{1, 2, 3};
    const double a = dot(motion, motion), b = dot(motion, o), c = dot(o, o) - (radius + r) * (radius + r);
    const auto hit = collider.sweep(Sphere{from, r}, motion * 2);
    if (b * b < a * c) {
      EXPECT_FALSE(hit);  // the facets lie within the sphere
      continue;
    }
    const double truth = (-b - std::sqrt(b * b - a * c)) / a;
    const double cosine = std::sqrt((b * b - a * c) / a) / (radius + r);
    if (cosine < 0.2) continue;  // a graze
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->time * 2, truth, 1.5 * facet / (std::sqrt(a) * cosine));
    const Vec3d center = from + motion * (2 * hit->time);
    EXPECT_NEAR(dot(hit->normal, normalized(center - Vec3d{1, 2, 3})), 1, 0.01);
  }
}

TEST(Collider, NothingPassesAThinPlateAtAnySpeed) {
  const MeshCollider collider(box_mesh({-50, -50, -0.0005}, {50, 50, 0.0005}));
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    const Vec3d through{random.uniform(-40, 40), random.uniform(-40, 40), 0};
    const double speed = std::exp(random.uniform(0, 14));
    const Vec3d direction = normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), -1});
    const Vec3d from = through - direction * 3;
    const double radius = i % 3 == 0 ? 0.001 : 0.4;
    const Capsule shape =
        i % 2 ? Capsule(from, from, radius) : Capsule(from, from + Vec3d{0, 0, 1.2}, radius);
    const auto hit = collider.sweep(shape, direction * (speed + 3));
    ASSERT_TRUE(hit);
    EXPECT_NEAR((from + direction * ((speed + 3) * hit->time)).z, 0.0005 + radius, 1e-6);
    EXPECT_NEAR(hit->normal.z, 1, 1e-9);
    ASSERT_TRUE(collider.ray(from, direction, speed + 3.01));
  }
}

TEST(Collider, AShapeDeepInRockIsToldAndShownOut) {
  const MeshCollider collider(box_mesh({-10, -10, -10}, {10, 10, 10}));
  const auto hit = collider.sweep(Sphere{{8, 1, 2}, 0.5}, {0, 0, 1});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->time, 0);
  EXPECT_NEAR(hit->depth, 2.5, 1e-9);
  EXPECT_NEAR(hit->normal.x, 1, 1e-9);
  EXPECT_TRUE(collider.overlaps(Sphere{{8, 1, 2}, 0.5}));
  // Its way out of the rock crosses the surface from behind.
  const auto out = collider.ray({8, 1, 2}, {1, 0, 0}, 5);
  ASSERT_TRUE(out);
  EXPECT_TRUE(out->from_rock);
}

TEST(Collider, ContactOfACapsuleThatASurfaceCrosses) {
  const MeshCollider collider(box_mesh({-10, -10, -10}, {10, 10, 0}));
  const Capsule shape({0, 0, -0.3}, {0, 0, 1}, 0.4);
  const auto contact = collider.contact(shape);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(contact->normal.z, 1, 1e-12);
  EXPECT_NEAR(contact->depth, 0.7, 1e-9);
  EXPECT_FALSE(collider.overlaps(shape.moved({0, 0, contact->depth})));
}

TEST(Collider, SlidingKeepsToTheFloorAndTheWall) {
  mesh::Mesh room = box_mesh({-20, -20, -1}, {20, 20, 0});
  testing::append(room, box_mesh({5, -20, -0.5}, {6, 20, 10}));
  const MeshCollider collider(room);
  const Capsule shape({0, 0, 0.45}, {0, 0, 1.4}, 0.4);
  const Slide slide = collider.slide(shape, {8, 3, -1});
  EXPECT_FALSE(slide.stuck);
  EXPECT_FALSE(collider.overlaps(shape.moved(slide.moved)));
  EXPECT_NEAR(slide.moved.x, 4.6, 0.01);
  EXPECT_NEAR(slide.moved.y, 3, 0.05);
  EXPECT_NEAR(slide.moved.z, -0.05, 0.01);
  EXPECT_GE(slide.hits.size(), 2u);
}

TEST(Collider, SlidingFirstFreesWhatOverlaps) {
  const MeshCollider collider(box_mesh({-20, -20, -5}, {20, 20, 0}));
  const Slide slide = collider.slide(Sphere{{0, 0, 0.1}, 0.5}, {1, 0, 0});
  EXPECT_FALSE(slide.stuck);
  EXPECT_NEAR(slide.moved.z, 0.4, 0.01);
  EXPECT_NEAR(slide.moved.x, 1, 1e-6);
}

TEST(Collider, SlidesNeverEndInRock) {
  const mesh::Mesh m = sphere_mesh({0, 0, 0}, 6, 4);
  mesh::Mesh cave = m;  // the hollow in a rock: the sphere turned inside out, with pillars
  for (auto& t : cave.triangles) std::swap(t[1], t[2]);
  testing::append(cave, box_mesh({-1, -1, -7}, {1.5, 0.5, 7}));
  const MeshCollider collider(cave);
  Random random(10);
  Capsule shape({3, 0, 0}, {3, 0, 1}, 0.4);
  for (int i = 0; i < 3000; ++i) {
    const Slide slide = collider.slide(shape, random_point(random, i % 10 ? 1 : 100));
    ASSERT_FALSE(slide.stuck);
    shape = shape.moved(slide.moved);
    ASSERT_FALSE(collider.overlaps(shape)) << i;
  }
}

TEST(Collider, BatchesGiveWhatOneByOneGives) {
  const MeshCollider collider(testing::soup(500, 10, 11));
  Random random(12);
  std::vector<Collider::Ray> rays;
  std::vector<Collider::Motion> motions;
  for (int i = 0; i < 1000; ++i) {
    rays.push_back({random_point(random, 10), random_point(random, 1), 20});
    motions.push_back({Sphere{random_point(random, 10), 0.3}, random_point(random, 5)});
  }
  std::vector<std::optional<RayHit>> ray_hits(rays.size());
  std::vector<std::optional<SweepHit>> sweep_hits(motions.size());
  collider.rays(rays, ray_hits);
  collider.sweeps(motions, sweep_hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto ray = collider.ray(rays[i].from, rays[i].direction, rays[i].distance);
    ASSERT_EQ(ray.has_value(), ray_hits[i].has_value());
    EXPECT_EQ(ray ? ray->distance : 0, ray_hits[i] ? ray_hits[i]->distance : 0);
    const auto sweep = collider.sweep(motions[i].shape, motions[i].motion);
    ASSERT_EQ(sweep.has_value(), sweep_hits[i].has_value());
    EXPECT_EQ(sweep ? sweep->time : 2, sweep_hits[i] ? sweep_hits[i]->time : 2);
  }
}

TEST(Collider, MotionsOfNoLengthAreLikeAnyOther) {
  const MeshCollider collider(box_mesh({-20, -20, -5}, {20, 20, 0}));
  for (double size : {0.0, 1e-320, 1e-170, 1e-12}) {
    // Clear of the ground, touching it, and in it.
    for (double height : {1.0, 0.5, 0.2, -0.3}) {
      const Slide slide = collider.slide(Sphere{{0, 0, height}, 0.5}, {0, size, -size});
      EXPECT_FALSE(slide.stuck);
      EXPECT_EQ(slide.freed, height < 0.5);
      EXPECT_NEAR(slide.moved.z, height < 0.5 ? 0.505 - height : 0, 0.006) << size << " " << height;
      EXPECT_NEAR(length(slide.moved), slide.moved.z, 1e-9);
    }
    const auto deep = collider.sweep(Sphere{{0, 0, 0.2}, 0.5}, {size, 0, 0});
    EXPECT_NEAR(deep.value().depth, 0.3, 1e-12);
  }
}

TEST(Collider, ThinShapesAreToldFromWhatTheyCross) {
  const MeshCollider collider(box_mesh({-20, -20, -5}, {20, 20, 0}));
  for (double radius : {1e-300, 1e-9, 1e-7, 1e-3}) {
    const Capsule needle({0.1, 0.2, 1}, {0.1, 0.2, -1}, radius);
    EXPECT_TRUE(collider.overlaps(needle)) << radius;
    EXPECT_NEAR(collider.contact(needle).value().depth, 1 + radius, 1e-9);
    EXPECT_FALSE(collider.overlaps(needle.moved({0, 0, 1.1})));
    EXPECT_FALSE(collider.contact(needle.moved({0, 0, 1.1})));
    EXPECT_NEAR(collider.sweep(needle.moved({0, 0, 2}), {0, 0, -4}).value().time, 0.25, 1e-3);
  }
}

TEST(Collider, ImmenseMotionsEnd) {
  volume::ScalarGrid grid{{{-10, -10, -10}, 1, {21, 21, 21}}, 1};
  const GridCollider collider(grid);
  for (double size : {1e9, 1e15, 1e20, 1e60, 1e149}) {
    const auto hit = collider.sweep(Sphere{{-size / 3, 0, 0}, 1}, {size, 0, 0});
    if (size < 1e14) {
      EXPECT_NEAR(hit.value().time, 1.0 / 3, 1e-6) << size;
    }
    (void)collider.slide(Sphere{{0, 0, 30}, 1}, {size, size, -size});
    (void)collider.closest({size, 0, -size}, size);
  }
}

TEST(Collider, DegenerateQueriesAreErrorsOrHarmless) {
  const MeshCollider collider(box_mesh({-1, -1, -1}, {1, 1, 1}));
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (double bad : {nan, inf}) {
    EXPECT_THAT(error_of([&] {
                  collider.ray({bad, 0, 0}, {1, 0, 0}, 1);
                }),
                ::testing::HasSubstr("the ray's origin is not finite"));
    EXPECT_THAT(error_of([&] {
                  collider.ray({0, 0, 0}, {bad, 0, 0}, 1);
                }),
                ::testing::HasSubstr("the ray's direction is not finite"));
    EXPECT_THAT(error_of([&] {
                  collider.sweep(Sphere{{0, 0, 0}, bad}, {1, 0, 0});
                }),
                ::testing::HasSubstr("cannot collide: give one above 0"));
    EXPECT_THAT(error_of([&] {
                  collider.sweep(Sphere{{0, 0, 0}, 1}, {0, bad, 0});
                }),
                ::testing::HasSubstr("the motion is not finite"));
    EXPECT_THAT(error_of([&] {
                  collider.closest({0, 0, bad}, 1);
                }),
                ::testing::HasSubstr("the point is not finite"));
    EXPECT_THAT(error_of([&] {
                  collider.overlaps(Sphere{{0, bad, 0}, 1});
                }),
                ::testing::HasSubstr("the shape's position is not finite"));
  }
  EXPECT_THAT(error_of([&] {
                collider.ray({0, 0, 0}, {0, 0, 0}, 1);
              }),
              ::testing::HasSubstr("the ray has no direction"));
  EXPECT_THAT(error_of([&] {
                collider.ray({0, 0, 0}, {0, 0, 1}, nan);
              }),
              ::testing::HasSubstr("a distance of nan m cannot be searched"));
  EXPECT_THAT(error_of([&] {
                collider.closest({0, 0, 0}, -1);
              }),
              ::testing::HasSubstr("a distance of -1 m cannot be searched"));
  EXPECT_THAT(error_of([&] {
                collider.sweep(Sphere{{0, 0, 0}, 0}, {1, 0, 0});
              }),
              ::testing::HasSubstr("a radius of 0 m cannot collide"));
  EXPECT_TRUE(collider.ray({5, 0, 0}, {-1, 0, 0}, inf));
  EXPECT_NEAR(collider.ray({5, 0, 0}, {-1e-310, 0, 0}, 9).value().distance, 4, 1e-12);
  EXPECT_FALSE(collider.ray({5, 0, 0}, {-1, 0, 0}, 0));
  EXPECT_THAT(error_of([&] {
                collider.sweep(Sphere{{0, 0, 0}, 1}, {1e200, 0, 0});
              }),
              ::testing::HasSubstr("the motion is not finite"));
  EXPECT_FALSE(collider.sweep(Sphere{{5, 0, 0}, 1}, {0, 0, 0}));
  EXPECT_TRUE(collider.sweep(Sphere{{5, 0.1, 0.1}, 1}, {-1e12, 0, 0}));
  EXPECT_TRUE(collider.sweep(Sphere{{1.5, 0, 0}, 1}, {0, 0, 0}));
  const MeshCollider nothing{mesh::Mesh{}};
  EXPECT_FALSE(nothing.solid({0, 0, 0}));
  EXPECT_FALSE(nothing.ray({0, 0, 0}, {0, 0, 1}, inf));
  EXPECT_FALSE(nothing.closest({0, 0, 0}, inf));
  EXPECT_FALSE(nothing.sweep(Sphere{{0, 0, 0}, 1}, {0, 0, 1}));
  mesh::Mesh broken = box_mesh({0, 0, 0}, {1, 1, 1});
  broken.triangles[0][0] = 99;
  EXPECT_THAT(error_of([&] { MeshCollider{broken}; }),
              ::testing::HasSubstr("a triangle names vertex 99 of 8"));
}

}  // namespace
}  // namespace tafoni::query
