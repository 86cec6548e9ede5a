#include "tafoni/query/routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/test/meshes.h"
#include "tafoni/query/walks.h"

namespace tafoni::query {
namespace {

using testing::append;
using testing::box_mesh;

/// Two rooms with a door between them, and a platform too high to climb.
mesh::Mesh rooms() {
  mesh::Mesh m = box_mesh({0, 0, -1}, {12, 8, 0});
  append(m, box_mesh({0, 0, 3}, {12, 8, 4}));
  for (const auto& [lo, hi] : {std::pair<Vec3d, Vec3d>{{-1, -1, -1}, {0, 9, 4}},
                               {{12, -1, -1}, {13, 9, 4}},
                               {{-1, -1, -1}, {13, 0, 4}},
                               {{-1, 8, -1}, {13, 9, 4}},
                               {{6, 0, -0.5}, {6.5, 3, 3.5}},
                               {{6, 4.6, -0.5}, {6.5, 8, 3.5}},
                               {{9, 5.5, -0.5}, {11.5, 7.5, 1}}})
    append(m, box_mesh(lo, hi));
  return m;
}

TEST(Routes, ReachWhatAWalkerCanReach) {
  const MeshCollider ground(rooms());
  const WalkerSettings walker;
  const Routes routes(ground, {&walker, 1}, {2, 2, 0.1});
  ASSERT_GT(routes.places().size(), 200u);
  std::size_t beyond = 0;
  for (Vec3d p : routes.places()) {
    EXPECT_NEAR(p.z, 0, 0.02);  // not on the platform
    EXPECT_FALSE(ground.overlaps(Walker(walker).capsule_at(p)));
    beyond += p.x > 7;
  }
  EXPECT_GT(beyond, 50u);
  EXPECT_LT(routes.nearest({10.2, 2.1, 0}), routes.places().size());
  EXPECT_EQ(routes.nearest({10, 6.5, 1}), routes.places().size());
}

TEST(Routes, AWayGoesThroughTheDoorAndCanBeWalked) {
  const MeshCollider ground(rooms());
  const WalkerSettings settings;
  const Routes routes(ground, {&settings, 1}, {2, 2, 0.1});
  const std::size_t from = routes.nearest({2, 2, 0}), to = routes.nearest({10, 2, 0});
  const auto path = routes.path(from, to);
  ASSERT_GT(path.size(), 16u);
  bool door = false;
  for (Vec3d p : routes.way(path)) door = door || (std::abs(p.x - 6.25) < 0.5 && p.y > 3 && p.y < 4.6);
  EXPECT_TRUE(door);
  Walker walker(settings, routes.places()[from]);
  const Walked walked = find_way(ground, walker, routes, from, to, 0.05);
  EXPECT_TRUE(walked.arrived);
  EXPECT_LT(length(walker.feet() - routes.places()[to]), 0.02);
  // With the first stretch closed there is another way.
  const Routes::Stretch closed{path[0], path[1]};
  const auto around = routes.path(from, to, {&closed, 1});
  ASSERT_FALSE(around.empty());
  EXPECT_NE(around[1], path[1]);
}

TEST(Routes, AreEmptyWhereOneCannotStand) {
  const MeshCollider ground(rooms());
  const WalkerSettings walker;
  EXPECT_TRUE(Routes(ground, {&walker, 1}, {6.25, 1, 0.1}).places().empty());
  EXPECT_TRUE(Routes(ground, {&walker, 1}, {2, 2, 40}).places().empty());
  EXPECT_THAT(error_of([&] {
                Routes(ground, {&walker, 1}, {2, 2, 0.1}, {.spacing = 0});
              }),
              ::testing::HasSubstr("places need a spacing"));
}

TEST(Routes, StandingPlacesOfAColumnComeFromAbove) {
  const MeshCollider ground(rooms());
  const WalkerSettings walker;
  const auto places = standing_places(ground, walker, 3, 3, 20, -5);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR(places[0].z, 4, 0.02);
  EXPECT_NEAR(places[1].z, 0, 0.02);
  const auto roofed = standing_places(ground, walker, 3, 3, 20, -5, true);
  ASSERT_EQ(roofed.size(), 1u);
  EXPECT_NEAR(roofed[0].z, 0, 0.02);
}

TEST(RandomWalks, AreCompletedAndTheSameEachTime) {
  const MeshCollider ground(rooms());
  WalkSettings settings;
  settings.count = 30;
  settings.around = 10;
  const auto a = random_walks(ground, ground.bounds(), settings);
  const auto b = random_walks(ground, ground.bounds(), settings);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(a[i].walked.arrived);
    EXPECT_EQ(a[i].overlap, 0);
    EXPECT_EQ(a[i].to, b[i].to);
    EXPECT_EQ(a[i].walked.moves, b[i].walked.moves);
  }
}

TEST(RandomWalks, TellWhereThereIsNoPlaceToStand) {
  const MeshCollider ground(box_mesh({0, 0, 0}, {1, 1, 1}));
  EXPECT_THAT(error_of([&] { random_walks(ground, ground.bounds(), {}); }),
              ::testing::HasSubstr("no place under rock was found"));
}

}  // namespace
}  // namespace tafoni::query
