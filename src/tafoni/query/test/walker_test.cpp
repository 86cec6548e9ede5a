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

TEST(Walker, AStillOneIsFreedLikeOneThatWalks) {
  mesh::Mesh m = floor_mesh();
  append(m, box_mesh({0.25, -5, -0.5}, {5, 5, 5}));
  const MeshCollider floor(floor_mesh()), wall(m);
  for (double wish : {0.0, 1e-320, 1e-9, 1.0})
    for (double seconds : {0.0, 1e-300, dt}) {
      Walker walker({}, {0, 0, 0.01});
      walk(walker, floor, {}, 0.3);
      ASSERT_TRUE(walker.grounded());
      EXPECT_TRUE(walker.move(wall, {0, wish, 0}, seconds)) << wish << " " << seconds;
      EXPECT_FALSE(wall.overlaps(walker.capsule()));
      EXPECT_NEAR(walker.feet().x, -0.105, 0.01);
      EXPECT_NEAR(walker.feet().y, wish * seconds, 0.01);
      EXPECT_TRUE(walker.grounded());
    }
  Walker flying({.gravity = 0}, {0, 0, 1});
  EXPECT_TRUE(flying.move(wall, {}, 0));
  EXPECT_NEAR(flying.feet().x, -0.105, 0.01);
}

/// How far off the nearest place is, of a lattice of places, at which it is in the air and above ground.
double nearest_by_trying(const Collider& ground, const Walker& walker, double most) {
  double best = most;
  const double grain = 0.2;
  const int n = static_cast<int>(most / grain);
  for (int k = -n; k <= n; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        const Vec3d by{grain * i, grain * j, grain * k}, feet = walker.feet() + by;
        if (length(by) >= best || ground.overlaps(walker.capsule_at(feet))) continue;
        const auto below = ground.ray(feet + Vec3d{0, 0, 0.3}, {0, 0, -1}, 1e6);
        if (below && !below->from_rock) best = length(by);
      }
  return best;
}

TEST(Walker, EscapesToTheNearestPlaceWhereItFits) {
  mesh::Mesh m = box_mesh({-50, -50, -20}, {50, 50, 0});
  append(m, box_mesh({-2, -3, 0.001}, {4, 3, 2.5}));
  append(m, box_mesh({4.001, -9, 0.001}, {9, 9, 9}));
  append(m, box_mesh({-2, 3.8, 0.001}, {3.99, 9, 9}));
  append(m, box_mesh({-20, -20, 4}, {20, 20, 6}));  // a roof: above the first block there is too little room
  const MeshCollider ground(m);
  Random random(5);
  for (int i = 0; i < 12; ++i) {
    Walker walker({}, {random.uniform(-2, 8), random.uniform(-3, 3), random.uniform(-1, 4)});
    const double nearest = nearest_by_trying(ground, walker, 8);
    const auto place = walker.free_place(ground, 20);
    ASSERT_TRUE(place) << i;
    EXPECT_FALSE(ground.overlaps(walker.capsule_at(*place)));
    const double way = length(*place - walker.feet());
    EXPECT_LE(way, 1.12 * nearest + 0.05) << i;
    ASSERT_TRUE(walker.escape(ground, 20));
    EXPECT_EQ(walker.feet(), *place);
    EXPECT_EQ(walker.free_place(ground, 0), walker.feet());
    walk(walker, ground, {0.5, 0.2, 0}, 3);
  }
}

TEST(Walker, IsNeverPushedOutOfTheWorld) {
  const MeshCollider ground(box_mesh({-50, -50, -2}, {50, 50, 20}));
  for (bool grounded : {false, true}) {
    Walker walker({}, {0, 0, -1});
    if (grounded) {
      walker = Walker({}, {0, 0, -0.99});
      const MeshCollider floor(box_mesh({-50, -50, -2}, {50, 50, -1}));
      walk(walker, floor, {}, 0.3);
      ASSERT_TRUE(walker.grounded());
    }
    const Vec3d feet = walker.feet();
    for (Vec3d wish : {Vec3d{}, Vec3d{1, 0, 0}}) {
      EXPECT_FALSE(walker.move(ground, wish, dt));
      EXPECT_TRUE(walker.stuck());
      EXPECT_EQ(walker.feet(), feet);
    }
    EXPECT_FALSE(walker.free_place(ground, 15));
    EXPECT_FALSE(walker.escape(ground, 15));
    EXPECT_EQ(walker.feet(), feet);
    EXPECT_TRUE(walker.escape(ground));
    EXPECT_FALSE(walker.stuck());
    walk(walker, ground, {}, 3);
    EXPECT_NEAR(walker.feet().z, 20, 0.01);
  }
  // One that has fallen out comes back.
  Walker falling({}, {49, 0, -30});
  EXPECT_TRUE(falling.escape(ground, 60));
  walk(falling, ground, {}, 3);
  EXPECT_NEAR(falling.feet().z, 20, 0.01);
  EXPECT_FALSE(Walker({}, {0, 0, 0}).escape(MeshCollider{mesh::Mesh{}}));
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
  EXPECT_THAT(error_of([&] { Walker({.step = INFINITY}); }),
              ::testing::HasSubstr("needs a step and gravity"));
  const MeshCollider ground(floor_mesh());
  Walker walker({}, {0, 0, 1});
  EXPECT_THAT(error_of([&] {
                walker.move(ground, {std::nan(""), 0, 0}, dt);
              }),
              ::testing::HasSubstr("wish is not finite"));
  EXPECT_THAT(error_of([&] { walker.move(ground, {}, -1); }),
              ::testing::HasSubstr("a move of -1 s cannot be made"));
  EXPECT_THAT(error_of([&] { (void)walker.free_place(ground, -1); }),
              ::testing::HasSubstr("a place within -1 m cannot be looked for"));
  EXPECT_THAT(error_of([&] { walker.move(ground, {}, std::nan("")); }),
              ::testing::HasSubstr("a move of nan s cannot be made"));
}

}  // namespace
}  // namespace tafoni::query
