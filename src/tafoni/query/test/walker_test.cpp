#include "tafoni/query/walker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/test/meshes.h"

namespace tafoni::query {
namespace {

using testing::append;
using testing::box_mesh;

constexpr double dt = 1.0 / 30;

mesh::Mesh floor_mesh() {
  return box_mesh({-50, -50, -1}, {50, 50, 0});
}

/// A ramp that rises along x from x = 2.
mesh::Mesh ramp_mesh(double degrees) {
  mesh::Mesh m;
  const double rise = 10 * std::tan(degrees * std::numbers::pi / 180);
  for (double y : {-10.0, 10.0})
    for (Vec2d p : {Vec2d{2, -0.5}, Vec2d{12, -0.5}, Vec2d{2, 0}, Vec2d{12, rise}})
      m.positions.push_back(to_float({p.x, y, p.y}));
  m.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 7, 5}, {4, 6, 7}, {0, 2, 6}, {0, 6, 4},
                 {1, 5, 7}, {1, 7, 3}, {2, 3, 7}, {2, 7, 6}, {0, 4, 5}, {0, 5, 1}};
  return m;
}

void walk(Walker& walker, const Collider& ground, Vec3d wish, double seconds) {
  for (double t = 0; t < seconds; t += dt) {
    walker.move(ground, wish, dt);
    ASSERT_FALSE(ground.overlaps(walker.capsule()));
    ASSERT_FALSE(walker.stuck());
  }
}

TEST(Walker, FallsAndStands) {
  const MeshCollider ground(floor_mesh());
  Walker walker({}, {0, 0, 5});
  double fastest = 0;
  for (int i = 0; i < 60; ++i) {
    walker.move(ground, {}, dt);
    fastest = std::max(fastest, -walker.velocity().z);
  }
  EXPECT_TRUE(walker.grounded());
  EXPECT_NEAR(walker.feet().z, 0, 0.01);
  EXPECT_NEAR(fastest, std::sqrt(2 * 9.81 * 5), 0.5);
}

TEST(Walker, WalksAtItsSpeedOnLevelGround) {
  const MeshCollider ground(floor_mesh());
  Walker walker({}, {0, 0, 0.01});
  walk(walker, ground, {}, 0.2);
  walk(walker, ground, {1.5, 0, 0}, 4);
  EXPECT_NEAR(walker.feet().x, 6, 0.1);
  EXPECT_TRUE(walker.grounded());
}

TEST(Walker, ClimbsStairsUpToItsStep) {
  for (double rise : {0.2, 0.4, 0.6}) {
    mesh::Mesh m = floor_mesh();
    for (int i = 0; i < 5; ++i) append(m, box_mesh({2 + 0.6 * i, -5, -1}, {12, 5, rise * (i + 1)}));
    const MeshCollider ground(m);
    Walker walker({}, {0, 0, 0.01});
    walk(walker, ground, {2, 0, 0}, 4);
    if (rise < walker.settings().step) {
      EXPECT_GT(walker.feet().x, 7) << rise;
      EXPECT_NEAR(walker.feet().z, 5 * rise, 0.02);
      // And down again without falling.
      for (int i = 0; i < 110; ++i) {
        walker.move(ground, {-2, 0, 0}, dt);
        EXPECT_TRUE(walker.grounded()) << rise << " " << walker.feet().x;
      }
      EXPECT_NEAR(walker.feet().z, 0, 0.02);
    } else {
      EXPECT_LT(walker.feet().x, 2);
      EXPECT_NEAR(walker.feet().z, 0, 0.02);
    }
  }
}

TEST(Walker, ClimbsSlopesUpToItsLimit) {
  for (double degrees : {20.0, 44.0, 50.0, 70.0}) {
    mesh::Mesh m = floor_mesh();
    append(m, ramp_mesh(degrees));
    const MeshCollider ground(m);
    Walker walker({}, {0, 0, 0.01});
    walk(walker, ground, {}, 0.2);
    walk(walker, ground, {1, 0, 0}, 6);
    if (degrees < 46) {
      EXPECT_NEAR(walker.feet().x, 6, 0.35) << degrees;
      EXPECT_TRUE(walker.grounded());
    } else {
      EXPECT_LT(walker.feet().z, 0.3) << degrees;
    }
  }
}

TEST(Walker, SlidesDownWhatIsTooSteep) {
  mesh::Mesh m = floor_mesh();
  append(m, ramp_mesh(60));
  const MeshCollider ground(m);
  Walker walker({}, {6, 0, 10});
  walk(walker, ground, {}, 5);
  EXPECT_TRUE(walker.grounded());
  EXPECT_LT(walker.feet().x, 2.1);
  EXPECT_NEAR(walker.feet().z, 0, 0.02);
}

TEST(Walker, StopsAtWallsAndSlidesAlongThem) {
  mesh::Mesh m = floor_mesh();
  append(m, box_mesh({3, -40, -0.5}, {4, 40, 5}));
  const MeshCollider ground(m);
  Walker walker({}, {0, 0, 0.01});
  walk(walker, ground, {}, 0.2);
  walk(walker, ground, {2, 1, 0}, 4);
  EXPECT_NEAR(walker.feet().x, 3 - walker.settings().radius, 0.02);
  EXPECT_NEAR(walker.feet().y, 4, 0.2);
}

TEST(Walker, DoesNotEnterWhatIsTooLow) {
  mesh::Mesh m = floor_mesh();
  append(m, box_mesh({3, -40, 1.6}, {9, 40, 5}));
  const MeshCollider ground(m);
  Walker walker({}, {0, 0, 0.01});
  walk(walker, ground, {2, 0, 0}, 4);
  EXPECT_LT(walker.feet().x, 3.2);
  Walker small({.radius = 0.3, .height = 1.5}, {0, 0, 0.01});
  walk(small, ground, {2, 0, 0}, 8);
  EXPECT_GT(small.feet().x, 10);
}

TEST(Walker, AClosingCleftHoldsItWithoutPressingItIn) {
  mesh::Mesh m = floor_mesh();
  // Two walls that meet: a wedge seen from above.
  for (int side : {-1, 1}) {
    mesh::Mesh wall = box_mesh({0, 0, -0.5}, {20, 1, 5});
    for (Vec3f& p : wall.positions) {
      const double y = side * (p.y + 2.0 - 0.2 * p.x);
      p.y = static_cast<float>(y);
    }
    if (side < 0)
      for (auto& t : wall.triangles) std::swap(t[0], t[1]);
    append(m, wall);
  }
  const MeshCollider ground(m);
  Walker walker({}, {0, 0, 0.01});
  walk(walker, ground, {3, 0.2, 0}, 6);
  EXPECT_LT(walker.feet().x, 9);
  EXPECT_GT(walker.feet().x, 7);
  walk(walker, ground, {-3, 0, 0}, 3);
  EXPECT_LT(walker.feet().x, 1);
}

TEST(Walker, TakesNoNotionOfHowLongAMoveIs) {
  mesh::Mesh m = floor_mesh();
  append(m, box_mesh({3, -40, -0.5}, {3.01, 40, 50}));
  const MeshCollider ground(m);
  Walker walker({}, {0, 0, 0.01});
  walker.move(ground, {}, 0.1);
  walker.move(ground, {1000, 0, 0}, 100);
  EXPECT_LT(walker.feet().x, 3);
  EXPECT_FALSE(ground.overlaps(walker.capsule()));
  Walker falling({}, {0, 0, 40000});
  falling.move(ground, {}, 1e5);
  EXPECT_GT(falling.feet().z, -0.001);
}

TEST(Walker, IsFreedWhenTheGroundRises) {
  const MeshCollider low(floor_mesh()), high(box_mesh({-50, -50, -1}, {50, 50, 0.5}));
  Walker walker({}, {0, 0, 0.01});
  walker.move(low, {}, 0.1);
  walker.move(high, {}, 0.1);
  EXPECT_FALSE(walker.stuck());
  EXPECT_FALSE(high.overlaps(walker.capsule()));
  EXPECT_NEAR(walker.feet().z, 0.5, 0.1);
}

TEST(Walker, TheSameMovesGiveTheSameBits) {
  const mesh::Mesh m = testing::soup(400, 8, 3);
  const MeshCollider ground(m);
  Walker a({}, {0, 0, 12}), b({}, {0, 0, 12});
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const Vec3d wish = testing::random_point(random, 4);
    a.move(ground, wish, dt);
    b.move(ground, wish, dt);
    ASSERT_EQ(a.feet(), b.feet());
  }
}

TEST(Walker, BadSizesAndWishesAreErrors) {
  EXPECT_THAT(error_of([&] { Walker({.radius = 0}); }), ::testing::HasSubstr("a walker of radius 0 m"));
  EXPECT_THAT(error_of([&] { Walker({.radius = 1, .height = 1}); }), ::testing::HasSubstr("is no capsule"));
  EXPECT_THAT(error_of([&] { Walker({.slope = 2}); }), ::testing::HasSubstr("a slope below 90 degrees"));
  EXPECT_THAT(error_of([&] { Walker({.skin = 0}); }), ::testing::HasSubstr("a skin and fall"));
  const MeshCollider ground(floor_mesh());
  Walker walker({}, {0, 0, 1});
  EXPECT_THAT(error_of([&] {
                walker.move(ground, {std::nan(""), 0, 0}, dt);
              }),
              ::testing::HasSubstr("wish is not finite"));
  EXPECT_THAT(error_of([&] { walker.move(ground, {}, -1); }),
              ::testing::HasSubstr("a move of -1 s cannot be made"));
  EXPECT_THAT(error_of([&] { walker.move(ground, {}, std::nan("")); }),
              ::testing::HasSubstr("a move of nan s cannot be made"));
}

}  // namespace
}  // namespace tafoni::query
