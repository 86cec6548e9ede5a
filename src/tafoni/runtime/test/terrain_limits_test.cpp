// What edits may not do to a terrain, whoever sent them: take more memory than allowed, dig through its
// floor, or hold a player for good.

#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/query/walker.h"
#include "tafoni/runtime/test/operations.h"
#include "tafoni/runtime/test/rocks.h"
#include "tafoni/scene/build/build.h"

namespace tafoni::runtime {
namespace {

using testing::HasSubstr;
using volume::Edit;
using volume::Tool;

TEST(TerrainLimits, EditsTakeNoMoreMemoryThanAllowed) {
  // A stranger fills air and rock with small balls, so that every chunk has surface.
  const auto ball = [](std::uint64_t i) {
    Random r(9, i);
    const double x = r.uniform(-24, 24), y = r.uniform(-24, 24), z = r.uniform(-16, 12);
    return encode(ToolUse{Tool::sphere({x, y, z}, 0.9), i % 2 ? Edit::add : Edit::remove});
  };
  DestructibleTerrainSettings settings;
  settings.memory = 12'000'000;
  DestructibleTerrain terrain = hills(settings), peer = hills(settings);
  int refused = 0;
  for (std::uint64_t i = 0; i < 1500; ++i) {
    const Message message = ball(i);
    const SnapshotPtr before = terrain.snapshot();
    const std::string said = error_of([&] { terrain.apply({&message, 1}); });
    // One who gets them in another rhythm refuses the same.
    EXPECT_EQ(error_of([&] { peer.apply({&message, 1}); }), said);
    if (i % 10 == 0) {
      EXPECT_THAT(error_of([&] { peer.apply(std::vector(3, Message(5))); }), HasSubstr("no edit"));
    }
    if (said.empty()) continue;
    EXPECT_THAT(said, HasSubstr("more than the 0.012 GB of DestructibleTerrainSettings::memory"));
    EXPECT_EQ(terrain.snapshot(), before);
    ++refused;
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(terrain.version(), 50u);
  EXPECT_EQ(terrain.state(), peer.state());
  std::uint64_t bytes = terrain.snapshot()->grid().bytes();
  for (const Vec3i c : terrain.snapshot()->chunks()) {
    const surface::GridChunkMesh& m = *terrain.chunk(c).mesh;
    bytes += 24 * m.positions.size() + 12 * m.triangles.size() + 4 * m.polygons.corners.size();
  }
  EXPECT_LT(bytes, settings.memory);
  EXPECT_GT(bytes, settings.memory / 3);
  // What was refused is not in the meshes either.
  surface::GridMesher anew({surface::Boundary::solid, true});
  anew.update(terrain.snapshot()->grid(), {});
  ASSERT_EQ(terrain.snapshot()->chunks(), anew.chunks());
  for (const Vec3i c : anew.chunks()) ASSERT_TRUE(same(*terrain.chunk(c).mesh, *anew.chunk(c)));
  EXPECT_EQ(terrain.mesh().triangles.size(), anew.assemble().triangles.size());

  settings.memory = 1'000'000;
  EXPECT_THAT(error_of([&] { hills(settings); }), HasSubstr("more than the 0.0 GB allowed"));
}

TEST(TerrainLimits, WhatRewindingKeepsCounts) {
  DestructibleTerrainSettings settings;
  settings.memory = 30'000'000;
  const auto edits_of = [&](bool rewind) {
    settings.rewind = rewind;
    DestructibleTerrain terrain = hills(settings);
    const Box3d box = world_box(terrain);
    for (std::uint64_t i = 0; i < 700; ++i) {
      const Message message = encode(random_operation(i, box, 2));
      (void)error_of([&] { terrain.apply({&message, 1}); });
    }
    return terrain.version();
  };
  EXPECT_EQ(edits_of(false), 701u);
  EXPECT_LT(edits_of(true), 701u);
  settings.memory = std::uint64_t{4} << 30;
  EXPECT_EQ(edits_of(true), 701u);
}

TEST(TerrainLimits, NothingDigsTheFloor) {
  for (const auto boundary : {surface::Boundary::open, surface::Boundary::solid})
    for (const std::optional<double> height :
         {std::optional<double>(), std::optional(3.0), std::optional(0.0)}) {
      DestructibleTerrainSettings settings;
      settings.boundary = boundary;
      settings.floor = height;
      settings.rewind = true;
      DestructibleTerrain terrain = hills(settings, volume::Precision::single, far_away);
      const volume::GridFrame frame = terrain.snapshot()->grid().frame();
      const double floor = frame.origin.z + height.value_or(1) - (height == 0.0 ? 0 : frame.spacing);
      EXPECT_NEAR(terrain.bounds().lo.z, far_away.z + floor, 1e-9);
      const Vec3d all = frame.box().size(), size = terrain.bounds().size();
      EXPECT_NEAR(length(size - all + Vec3d{0, 0, floor - frame.origin.z}), 0, 1e-9);
      const SnapshotPtr before = terrain.snapshot();
      const Vec3d low = far_away + Vec3d{0, 0, -15.5};
      terrain.apply(Tool::sphere(low, 6), Edit::remove);
      terrain.apply(Tool::box(low + Vec3d{9, 0, 0}, {2, 2, 5}), Edit::remove);
      terrain.explode(low + Vec3d{-12, 0, 0}, 5, 1e6);
      terrain.apply(Radial{low + Vec3d{0, 12, 0}, 5, {-9, 1e6, -1e6}});
      terrain.rewind(3);
      terrain.apply(Tool::capsule(low + Vec3d{-20, -20, 0}, low + Vec3d{20, 20, 0}, 3), Edit::remove);
      const SnapshotPtr now = terrain.snapshot();
      int changed_below = 0;
      volume::SampleBox layer = now->grid().samples();
      for (int z = 0; z < 12; ++z) {
        layer.lo.z = layer.hi.z = z;
        std::vector<float> a(layer.count()), b(layer.count());
        before->grid().read(layer, a.data());
        now->grid().read(layer, b.data());
        if (frame.position({0, 0, z}).z > floor + 1e-9) {
          EXPECT_NE(a, b) << z;
        } else {
          changed_below += a != b;
        }
      }
      EXPECT_EQ(changed_below, height == 0.0 ? 1 : 0);
      const auto hit = now->ray(low + Vec3d{0, 0, 3}, {0, 0, -1}, 20);
      if (height != 0.0) {
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->point.z, far_away.z + floor, frame.spacing);
      }
      settings.floor = 5;
      EXPECT_NE(hills(settings, volume::Precision::single, far_away).base(), terrain.base());
    }
}

TEST(TerrainLimits, WhoDigsDownStaysInTheWorld) {
  for (const char* boundary : {"solid", "open"}) {
    const auto text = std::string("scene = { voxel = 1, boundary = \"") + boundary +
                      "\" }\nterrain = { generator = \"coast\", width = 60, height = 60 }\n";
    DestructibleTerrain ground(scene::build(scene::parse_scene(text, "coast.toml")));
    SnapshotPtr now = ground.snapshot();
    const auto top = now->ray({30, 50, 500}, {0, 0, -1}, 1000);
    ASSERT_TRUE(top);
    query::Walker player({}, now->to_local(top->point + Vec3d{0, 0, 0.05}));
    const double lowest = ground.bounds().lo.z;
    ASSERT_GT(top->point.z - lowest, 10);
    for (int frame = 0; frame < 1200; ++frame) {
      if (frame % 6 == 0) ground.apply(Tool::sphere(now->to_world(player.feet()), 1.5), Edit::remove);
      now = ground.snapshot();
      player.move(now->collider(), {}, 1.0 / 60);
    }
    EXPECT_TRUE(player.grounded()) << boundary;
    EXPECT_NEAR(now->to_world(player.feet()).z, lowest, 1.1) << boundary;
  }
}

TEST(TerrainLimits, PlayersWhoAreBuriedGetOut) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    Random r(31, i);
    DestructibleTerrain ground = hills({});
    SnapshotPtr now = ground.snapshot();
    const double x = r.uniform(-20, 20), y = r.uniform(-20, 20);
    query::Walker player({}, {x, y, 6});
    for (int f = 0; f < 90; ++f) player.move(now->collider(), {}, 1.0 / 60);
    ASSERT_TRUE(player.grounded());
    const Vec3d off{r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(0, 2)};
    const double size = r.uniform(0.5, 3);
    ground.apply(
        i % 2 ? Tool::sphere(player.feet() + off, size) : Tool::box(player.feet() + off, {size, size, size}),
        Edit::add);
    now = ground.snapshot();
    const Vec3d wish = i % 4 < 2 ? Vec3d{} : Vec3d{1.5, 0, 0};
    for (int f = 0; f < 120; ++f) {
      const bool out = player.move(now->collider(), wish, 1.0 / 60) || player.escape(now->collider());
      ASSERT_TRUE(out) << i;
    }
    EXPECT_FALSE(now->overlaps(player.capsule())) << i;
    EXPECT_TRUE(player.grounded()) << i;
  }
}

}  // namespace
}  // namespace tafoni::runtime
