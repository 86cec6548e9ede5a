#include "tafoni/query/field_collider.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/field/tree.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/test/meshes.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::query {
namespace {

using testing::random_point;

constexpr double side = 60;

/// A block of hilly ground, 60 m a side, with passages of points.
field::NodePtr hill(std::uint64_t seed, int passages = 12) {
  constexpr int n = 33;
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(n, n);
  heights->placement = {.west = 0, .north = side, .dx = side / (n - 1), .dy = side / (n - 1)};
  for (int row = 0; row < n; ++row)
    for (int col = 0; col < n; ++col)
      heights->values.at(col, row) =
          static_cast<float>(6 * std::sin(0.31 * col) * std::cos(0.23 * row) + 2 * std::sin(0.9 * col + row));
  const field::HeightfieldSettings terrain{.influence = 6, .amplitude = 3};
  const field::Domain domain{.box = {{2, 2, -25}, {side - 2, side - 2, 40}}, .inside = {}};
  field::CloudBuilder cloud(field::CloudSettings{});
  Random random(seed);
  for (int p = 0; p < passages; ++p) {
    Vec3d at{random.uniform(8, 52), random.uniform(8, 52), random.uniform(-12, 2)};
    for (int i = 0; i < 15; ++i) {
      field::add_point(cloud, at, random.uniform(3, 4), -4);
      at += normalized(random_point(random, 1)) * 1.8;
    }
  }
  const field::NodePtr open = field::blend({field::heightfield(heights, terrain), cloud.finish()});
  return field::intersect({open, field::domain(domain, terrain)});
}

class FieldAndMesh : public ::testing::TestWithParam<double> {
 protected:
  FieldAndMesh() {
    surface::PolygonizeSettings settings;
    settings.voxel = GetParam();
    mesh_ = surface::polygonize(field_, settings);
  }
  Vec3d somewhere(Random& random) const {
    return {random.uniform(-3, side + 3), random.uniform(-3, side + 3), random.uniform(-28, 14)};
  }
  const field::CompiledField field_ = field::compile(hill(1));
  mesh::Mesh mesh_;
};

TEST_P(FieldAndMesh, GiveTheSameAnswers) {
  const FieldCollider collider(field_, {.voxel = GetParam()});
  const MeshCollider peer(mesh_);
  Random random(2);
  int rays = 0, sweeps = 0, rocks = 0;
  for (int i = 0; i < 1500; ++i) {
    const Vec3d p = somewhere(random), direction = random_point(random, 1);
    const double distance = random.uniform(1, 80);
    const auto ray = collider.ray(p, direction, distance), ray_peer = peer.ray(p, direction, distance);
    ASSERT_EQ(ray.has_value(), ray_peer.has_value()) << i;
    if (ray) {
      ++rays;
      EXPECT_EQ(ray->distance, ray_peer->distance);
      EXPECT_EQ(ray->from_rock, ray_peer->from_rock);
    }
    const double reach = i % 10 ? random.uniform(0.1, 6) : 200;
    const auto near = collider.closest(p, reach), near_peer = peer.closest(p, reach);
    ASSERT_EQ(near.has_value(), near_peer.has_value()) << i;
    if (near) {
      EXPECT_EQ(near->distance, near_peer->distance);
      EXPECT_NEAR(length(near->normal - near_peer->normal), 0, 1e-9);
    }
    const bool rock = collider.solid(p);
    EXPECT_EQ(rock, peer.solid(p)) << i;
    rocks += rock;
    const double radius = std::exp(random.uniform(-3, 1));
    const Capsule shape(p, i % 2 ? p : p + Vec3d{0, 0, 1.2}, radius);
    EXPECT_EQ(collider.overlaps(shape), peer.overlaps(shape)) << i;
    const Vec3d motion = random_point(random, i % 5 ? 3 : 60);
    const auto hit = collider.sweep(shape, motion), hit_peer = peer.sweep(shape, motion);
    ASSERT_EQ(hit.has_value(), hit_peer.has_value()) << i;
    if (!hit) continue;
    sweeps += hit->depth == 0;
    EXPECT_EQ(hit->time, hit_peer->time);
    EXPECT_NEAR(hit->depth, hit_peer->depth, 1e-9);
  }
  EXPECT_GT(rays, 300);
  EXPECT_GT(sweeps, 100);
  EXPECT_GT(rocks, 300);
}

/// Solidity of the field itself, but within what the mesh may be off near its surface.
TEST_P(FieldAndMesh, RockIsWhereTheFieldIsAboveZero) {
  const FieldCollider collider(field_, {.voxel = GetParam()});
  Random random(3);
  int told = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p = somewhere(random);
    const bool rock = collider.solid(p);
    const float f = field_.value(p);
    if (rock == (f > 0)) {
      ++told;
      continue;
    }
    EXPECT_TRUE(collider.closest(p, GetParam())) << i;
  }
  EXPECT_GT(told, 19500);
}

INSTANTIATE_TEST_SUITE_P(Voxels, FieldAndMesh, ::testing::Values(0.4, 0.9));

TEST(FieldCollider, LooksOnlyNearTheQuery) {
  const field::CompiledField field = field::compile(hill(4));
  const FieldCollider collider(field, {.voxel = 0.25});
  collider.sweep(Sphere{{30, 30, 20}, 0.4}, {0.5, 0, 0});
  EXPECT_LE(collider.cache().made, 8u);
  collider.ray({30, 30, 300}, {0, 0, -1}, 1000);
  EXPECT_LE(collider.cache().made, 60u);
}

TEST(FieldCollider, ASmallCacheChangesNothing) {
  const field::CompiledField field = field::compile(hill(5));
  const FieldCollider large(field, {.voxel = 0.5}), small(field, {.voxel = 0.5, .cache_bytes = 1 << 18});
  Random random(6);
  for (int i = 0; i < 400; ++i) {
    const Vec3d p{random.uniform(0, side), random.uniform(0, side), random.uniform(-20, 12)};
    const Vec3d motion = random_point(random, 5);
    const auto a = large.sweep(Sphere{p, 0.4}, motion), b = small.sweep(Sphere{p, 0.4}, motion);
    ASSERT_EQ(a.has_value(), b.has_value());
    EXPECT_EQ(a ? a->time : 2, b ? b->time : 2);
  }
  EXPECT_LT(small.cache().bytes, (1u << 18) + 16 * 200000u);
  EXPECT_LT(small.cache().tiles, large.cache().tiles);
}

TEST(FieldCollider, ManyThreadsGetWhatOneGets) {
  const field::CompiledField field = field::compile(hill(7));
  const auto ask = [](const FieldCollider& collider, std::uint64_t seed) {
    std::vector<double> times;
    Random random(seed);
    for (int i = 0; i < 400; ++i) {
      const Vec3d p{random.uniform(0, side), random.uniform(0, side), random.uniform(-20, 12)};
      const auto hit = collider.sweep(Sphere{p, 0.4}, random_point(random, 5));
      times.push_back(hit ? hit->time + hit->depth : -1);
    }
    return times;
  };
  const FieldCollider shared(field, {.voxel = 0.5, .cache_bytes = 1 << 20});
  std::vector<std::vector<double>> found(4);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < found.size(); ++t)
    threads.emplace_back([&, t] { found[t] = ask(shared, 8 + t % 2); });
  for (std::thread& t : threads) t.join();
  for (std::size_t t = 0; t < found.size(); ++t)
    EXPECT_EQ(found[t], ask(FieldCollider(field, {.voxel = 0.5}), 8 + t % 2));
}

TEST(FieldCollider, AnUpdatedFieldIsMetWhereItChanged) {
  const field::NodePtr before = hill(9);
  FieldCollider collider(field::compile(before), {.voxel = 0.5});
  const Vec3d above{30, 30, 30};
  const auto ground = collider.ray(above, {0, 0, -1}, 100);
  ASSERT_TRUE(ground);
  field::CloudBuilder cloud(field::CloudSettings{});
  field::add_point(cloud, ground->point, 4, -8);
  const field::NodePtr stroke = cloud.finish();
  const field::CompiledField now = field::compile(field::blend({before, stroke}));
  const Box3d changed = field::support(stroke);
  collider.update(now, {&changed, 1});
  const auto deeper = collider.ray(above, {0, 0, -1}, 100);
  ASSERT_TRUE(deeper);
  EXPECT_GT(deeper->distance, ground->distance + 1);
  const FieldCollider anew(now, {.voxel = 0.5});
  Random random(10);
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = ground->point + random_point(random, 8);
    const auto a = collider.closest(p, 10), b = anew.closest(p, 10);
    ASSERT_EQ(a.has_value(), b.has_value());
    EXPECT_EQ(a ? a->distance : 0, b ? b->distance : 0);
  }
}

TEST(FieldCollider, BadVoxelsAreErrors) {
  const field::CompiledField field = field::compile(hill(11));
  EXPECT_THAT(error_of([&] { FieldCollider(field, {.voxel = 0}); }),
              ::testing::HasSubstr("a voxel of 0 m cannot be used"));
  EXPECT_THAT(error_of([&] { FieldCollider(field, {.voxel = std::nan("")}); }),
              ::testing::HasSubstr("a voxel of nan m cannot be used"));
  EXPECT_THAT(error_of([&] { FieldCollider(field, {.voxel = 1e-9}); }),
              ::testing::HasSubstr("too large for a voxel of 1e-09 m"));
}

TEST(FieldCollider, ShapesFarLargerThanTheGroundAskOnlyTheGround) {
  const field::CompiledField field = field::compile(hill(1));
  const FieldCollider collider(field, {.voxel = 1});
  surface::PolygonizeSettings settings;
  settings.voxel = 1;
  const MeshCollider peer(surface::polygonize(field, settings));
  for (const double radius : {1e3, 1e12}) {
    const Sphere sphere{{30, 30, radius + 2}, radius};
    EXPECT_EQ(collider.overlaps(sphere), peer.overlaps(sphere));
    const auto contact = collider.contact(sphere), peer_contact = peer.contact(sphere);
    ASSERT_EQ(contact.has_value(), peer_contact.has_value());
    if (contact) {
      EXPECT_EQ(contact->depth, peer_contact->depth);
    }
  }
  EXPECT_LT(collider.cache().made, 1000u);
}

}  // namespace
}  // namespace tafoni::query
