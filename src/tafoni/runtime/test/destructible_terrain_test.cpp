#include "tafoni/runtime/destructible_terrain.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/runtime/test/operations.h"
#include "tafoni/runtime/test/rocks.h"
#include "tafoni/scene/build/build.h"

namespace tafoni::runtime {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using volume::Edit;
using volume::Tool;

TEST(DestructibleTerrain, LocalMeshesEqualTheWholeByteForByte) {
  for (const auto boundary : {surface::Boundary::open, surface::Boundary::solid})
    for (const auto precision : {volume::Precision::single, volume::Precision::half}) {
      DestructibleTerrainSettings settings;
      settings.boundary = boundary;
      DestructibleTerrain terrain = hills(settings, precision);
      const Box3d box = world_box(terrain);
      for (std::uint64_t i = 0; i < 120; ++i) {
        terrain.apply(random_operation(i, box, 4));
        if (i % 12 != 0) continue;
        const SnapshotPtr now = terrain.snapshot();
        surface::GridMesher anew({boundary, true});
        anew.update(now->grid(), {});
        ASSERT_EQ(now->chunks(), anew.chunks());
        for (const Vec3i c : anew.chunks()) ASSERT_TRUE(same(*now->chunk(c).mesh, *anew.chunk(c))) << i;
      }
    }
}

TEST(DestructibleTerrain, ChangesAreTheChunksWhoseMeshDiffers) {
  DestructibleTerrain terrain = hills({});
  EXPECT_EQ(terrain.version(), 1u);
  EXPECT_EQ(names(terrain.changes_since(0).chunks), terrain.snapshot()->chunks());
  EXPECT_THAT(terrain.changes_since(1).chunks, ElementsAre());
  EXPECT_THAT(terrain.changes_since(std::numeric_limits<std::uint64_t>::max()).chunks, ElementsAre());
  const Box3d box = world_box(terrain);
  std::vector<SnapshotPtr> history{nullptr, terrain.snapshot()};
  std::size_t none = 0, some = 0;
  for (std::uint64_t i = 0; i < 150; ++i) {
    const std::uint64_t version = terrain.apply(random_operation(i, box, 3));
    EXPECT_EQ(version, i + 2);
    EXPECT_EQ(terrain.version(), version);
    history.push_back(terrain.snapshot());
    const auto changes = terrain.changes_since(version - 1);
    EXPECT_EQ(changes.version, version);
    EXPECT_EQ(names(changes.chunks), differing(*history[version - 1], *history[version]));
    changes.chunks.empty() ? ++none : ++some;
    for (const surface::ChunkChange& change : changes.chunks) {
      EXPECT_EQ(change.version, version);
      EXPECT_EQ(terrain.chunk(change.chunk).version, version);
    }
  }
  EXPECT_GT(none, 5u);
  EXPECT_GT(some, 50u);
  for (const std::uint64_t since : {std::uint64_t{1}, std::uint64_t{40}, std::uint64_t{149}}) {
    // A chunk may have changed there and back; every one that differs now is told.
    const auto told = terrain.changes_since(since).chunks;
    for (const Vec3i c : differing(*history[since], *history.back()))
      EXPECT_THAT(names(told), ::testing::Contains(c));
    for (const surface::ChunkChange& change : told) {
      EXPECT_GT(change.version, since);
      EXPECT_EQ(terrain.chunk(change.chunk).version, change.version);
    }
  }
}

TEST(DestructibleTerrain, OldSnapshotsStayAsTheyWere) {
  DestructibleTerrain terrain = hills({});
  const SnapshotPtr old = terrain.snapshot();
  const volume::ScalarGrid grid = old->grid();
  std::vector<surface::GridChunkMesh> meshes;
  for (const Vec3i c : old->chunks()) meshes.push_back(*old->chunk(c).mesh);
  const Box3d box = world_box(terrain);
  for (std::uint64_t i = 0; i < 100; ++i) terrain.apply(random_operation(i, box, 4));
  EXPECT_EQ(old->version(), 1u);
  EXPECT_TRUE(old->grid() == grid);
  const auto chunks = old->chunks();
  ASSERT_EQ(chunks.size(), meshes.size());
  for (std::size_t i = 0; i < chunks.size(); ++i) EXPECT_TRUE(same(*old->chunk(chunks[i]).mesh, meshes[i]));
}

TEST(DestructibleTerrain, WorldPositionsFarFromZeroLoseNothing) {
  DestructibleTerrain here = hills({}), there = hills({}, volume::Precision::single, far_away);
  const Box3d box = world_box(here);
  for (std::uint64_t i = 0; i < 60; ++i) {
    Random r(5, i);
    const auto eighth = [&](double lo, double hi) { return std::round(r.uniform(lo, hi) * 8) / 8; };
    const double x = eighth(box.lo.x, box.hi.x), y = eighth(box.lo.y, box.hi.y);
    const Vec3d at{x, y, eighth(-3, 3)};
    here.explode(at, 3, 4);
    there.explode(at + far_away, 3, 4);
    here.apply(Tool::sphere(at, 1.5), Edit::remove);
    there.apply(Tool::sphere(at + far_away, 1.5), Edit::remove);
  }
  const SnapshotPtr a = here.snapshot(), b = there.snapshot();
  EXPECT_TRUE(a->grid() == b->grid());
  ASSERT_EQ(a->chunks(), b->chunks());
  for (const Vec3i c : a->chunks()) {
    EXPECT_TRUE(same(*a->chunk(c).mesh, *b->chunk(c).mesh));
    EXPECT_EQ(b->chunk(c).origin, far_away);
  }
  const auto hit = b->ray(far_away + Vec3d{1, 2, 50}, {0, 0, -1}, 100);
  const auto near = a->ray({1, 2, 50}, {0, 0, -1}, 100);
  ASSERT_TRUE(hit && near);
  EXPECT_NEAR(hit->distance, near->distance, 1e-8);
  EXPECT_NEAR(length(hit->point - far_away - near->point), 0, 1e-8);
}

TEST(DestructibleTerrain, QueriesMeetWhatWasDug) {
  DestructibleTerrain terrain = hills({});
  const Vec3d inside{0, 0.1, -6.1};
  ASSERT_TRUE(terrain.snapshot()->solid(inside));
  const SnapshotPtr before = terrain.snapshot();
  terrain.apply(Tool::capsule({-20, 0.1, -6.1}, {20, 0.1, -6.1}, 2), Edit::remove);
  const SnapshotPtr now = terrain.snapshot();
  EXPECT_TRUE(before->solid(inside));
  EXPECT_FALSE(now->solid(inside));
  const auto down = now->ray(inside, {0, 0, -1}, 10);
  ASSERT_TRUE(down);
  EXPECT_NEAR(down->distance, 2, 0.02);
  EXPECT_GT(down->normal.z, 0.9);
  EXPECT_NEAR(now->closest(inside, 10)->distance, 2, 0.05);
  EXPECT_FALSE(now->overlaps(query::Sphere{inside, 1.9}));
  EXPECT_TRUE(now->overlaps(query::Sphere{inside, 2.1}));
  EXPECT_FALSE(now->sweep(query::Sphere{inside, 1}, {15, 0, 0}));
  EXPECT_NEAR(now->sweep(query::Sphere{inside, 1}, {0, 10, 0})->time, 0.1, 0.005);
  const query::Slide slide = now->slide(query::Sphere{inside, 1}, {5, 10, 0});
  EXPECT_GT(slide.moved.x, 2);
  EXPECT_FALSE(now->overlaps(query::Sphere{inside + slide.moved, 1}));
  ASSERT_TRUE(now->contact(query::Sphere{inside + Vec3d{0, 1.5, 0}, 1}));
  EXPECT_NEAR(now->contact(query::Sphere{inside + Vec3d{0, 1.5, 0}, 1})->depth, 0.5, 0.05);
}

TEST(DestructibleTerrain, EveryThreadCountGivesTheSameBytes) {
  std::vector<SnapshotPtr> ends;
  std::vector<DestructibleTerrain::State> states;
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    DestructibleTerrain terrain = hills({});
    const Box3d box = world_box(terrain);
    for (std::uint64_t i = 0; i < 60; ++i) terrain.apply(random_operation(i, box, 4));
    ends.push_back(terrain.snapshot());
    states.push_back(terrain.state());
  }
  set_thread_count(0);
  for (std::size_t i = 1; i < ends.size(); ++i) {
    EXPECT_TRUE(ends[i]->grid() == ends[0]->grid());
    EXPECT_EQ(states[i], states[0]);
    EXPECT_THAT(differing(*ends[i], *ends[0]), ElementsAre());
  }
}

TEST(DestructibleTerrain, PeersThatMakeTheSameEditsAgree) {
  DestructibleTerrain a = hills({}), b = hills({}), late = hills({});
  EXPECT_EQ(a.base(), b.base());
  const Box3d box = world_box(a);
  for (std::uint64_t i = 0; i < 80; ++i) {
    const Message message = encode(random_operation(i, box, 4));
    a.apply({&message, 1});
    b.apply({&message, 1});
    if (i % 20 == 0) {
      EXPECT_EQ(a.state(), b.state());
    }
  }
  late.apply(a.edits_since(1));
  EXPECT_EQ(late.state(), a.state());
  EXPECT_THAT(differing(*late.snapshot(), *a.snapshot()), ElementsAre());
  EXPECT_EQ(a.edits_since(80).size(), 1u);
  EXPECT_EQ(a.edits_since(81).size(), 0u);
  // One edit more, or one in another order, shows.
  a.explode(box.center(), 3, 2);
  EXPECT_NE(a.state().hash, b.state().hash);
  EXPECT_NE(a.base(), hills({}, volume::Precision::half).base());
  EXPECT_NE(a.base(), hills({}, volume::Precision::single, far_away).base());
}

TEST(DestructibleTerrain, RefusedEditsChangeNothing) {
  DestructibleTerrain terrain = hills({});
  const SnapshotPtr before = terrain.snapshot();
  const auto state = terrain.state();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] {
                terrain.explode({nan, 0, 0}, 1, 1);
              }),
              HasSubstr("a finite centre and a radius above 0"));
  EXPECT_THAT(error_of([&] { terrain.explode({0, 0, 0}, -1, 1); }), HasSubstr("a radius above 0, not -1"));
  std::vector<Message> messages{encode(Explosion{{0, 0, 0}, 4, 5}), Message(7)};
  EXPECT_THAT(error_of([&] { terrain.apply(messages); }), HasSubstr("a message of 7 bytes is no edit"));
  Progress cancelled;
  cancelled.cancel();
  messages.pop_back();
  EXPECT_THAT(error_of([&] { terrain.apply(messages, cancelled); }), HasSubstr("cancelled"));
  EXPECT_EQ(terrain.snapshot(), before);
  EXPECT_EQ(terrain.state(), state);
  terrain.apply(messages);
  DestructibleTerrain other = hills({});
  other.apply(messages);
  EXPECT_EQ(terrain.state(), other.state());
  EXPECT_THAT(differing(*terrain.snapshot(), *other.snapshot()), ElementsAre());
}

TEST(DestructibleTerrain, EditsOfMoreWorkThanAllowedAreRefused) {
  // With the band of 2 m about it 28 x 28 x 18 m, so about 57 x 57 x 37 samples of 0.5 m.
  const Vec3d half{12, 12, 7};
  const volume::Tool box = volume::Tool::box({0, 0, -2}, half);
  DestructibleTerrainSettings settings;
  settings.edit_work = 130000;
  DestructibleTerrain terrain = hills(settings);
  terrain.apply(box, Edit::remove);
  const auto state = terrain.state();
  const auto refused = [&](const Operation& operation) {
    try {
      const Message message = encode(operation);
      terrain.apply({&message, 1});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_THAT(error.what(), HasSubstr("edit_work"));
      EXPECT_EQ(terrain.state(), state);
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refused(ToolUse{volume::Tool::box({0, 0, -2}, half * 1.1), Edit::remove}));
  EXPECT_TRUE(refused(ToolUse{volume::Tool::sphere({0, 0, 0}, 1e9), Edit::remove}));
  EXPECT_TRUE(refused(Explosion{{0, 0, 0}, 30, 1}));
  EXPECT_TRUE(refused(Radial{{0, 0, 0}, 30, {1, 1}}));
  // Each side of a hull is a plane that every sample is asked about.
  std::vector<Vec3d> corners;
  for (const double x : {-half.x, half.x})
    for (const double y : {-half.y, half.y})
      for (const double z : {-half.z - 2, half.z - 2}) corners.push_back({x, y, z});
  EXPECT_TRUE(refused(ToolUse{volume::Tool::hull(corners), Edit::remove}));
  for (Vec3d& c : corners) c = c * 0.25;
  EXPECT_FALSE(refused(ToolUse{volume::Tool::hull(corners), Edit::remove}));
  // What lies beyond the ground costs nothing, however large it is.
  EXPECT_NO_THROW(terrain.apply(volume::Tool::sphere({2e9, 0, 0}, 1e9), Edit::remove));
}

TEST(DestructibleTerrain, NoEditLeavesValuesThatAreNotNumbers) {
  DestructibleTerrain terrain = hills({});
  const double most = std::numeric_limits<double>::max();
  terrain.apply(Radial{{0, 0, 0}, 3, {most, -most, most}});
  terrain.explode({5, 0, 0}, 3, most);
  terrain.explode({5, 0, 0}, 1e-200, -most);
  terrain.apply(volume::Tool::sphere({most, 0, 0}, most), volume::Edit::remove);
  terrain.apply(volume::Tool::capsule({-most, 0, 0}, {most, 0, 0}, 1), volume::Edit::add);
  const SnapshotPtr now = terrain.snapshot();
  const volume::SampleBox all = now->grid().samples();
  const Vec3i n = all.size();
  std::vector<float> values(static_cast<std::size_t>(n.x) * n.y * n.z);
  now->grid().read(all, values.data());
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return std::abs(v) <= 2; }));
}

TEST(DestructibleTerrain, RewindsToAnyVersion) {
  DestructibleTerrainSettings settings;
  settings.rewind = true;
  DestructibleTerrain terrain = hills(settings);
  const Box3d box = world_box(terrain);
  std::vector<SnapshotPtr> past{nullptr, terrain.snapshot()};
  std::vector<Digest> hashes{0, terrain.state().hash};
  Random r(6);
  int rewinds = 0;
  for (std::uint64_t i = 0; i < 700; ++i) {
    std::uint64_t to = 0;
    if (r.below(8) == 0) {
      const std::uint64_t back = r.below(2) == 0 ? r.below(4) : r.below(terrain.version());
      to = terrain.version() - back;
      terrain.rewind(to);
      ++rewinds;
    } else {
      terrain.apply(random_operation(i, box, 3));
    }
    past.push_back(terrain.snapshot());
    hashes.push_back(terrain.state().hash);
    EXPECT_EQ(past.size(), terrain.version() + 1);
    if (to == 0) continue;
    EXPECT_EQ(hashes.back(), hashes[to]) << i;
    EXPECT_THAT(differing(*past.back(), *past[to]), ElementsAre()) << i;
    EXPECT_EQ(names(terrain.changes_since(terrain.version() - 1).chunks),
              differing(*past[past.size() - 2], *past.back()));
  }
  EXPECT_GT(rewinds, 50);
  DestructibleTerrain late = hills(settings);
  late.apply(terrain.edits_since(1));
  EXPECT_EQ(late.state(), terrain.state());
  EXPECT_THAT(differing(*late.snapshot(), *terrain.snapshot()), ElementsAre());

  EXPECT_THAT(error_of([&] { terrain.rewind(0); }), HasSubstr("none rewinds to 0"));
  EXPECT_THAT(error_of([&] { terrain.rewind(terrain.version() + 1); }),
              HasSubstr("cannot be rewound to version"));
  DestructibleTerrain forgetful = hills({});
  EXPECT_THAT(error_of([&] { forgetful.rewind(1); }), HasSubstr("does not keep its past"));
  EXPECT_EQ(forgetful.version(), 1u);
}

TEST(DestructibleTerrain, RewindsAfterEditsThatWereNotMade) {
  DestructibleTerrainSettings settings;
  settings.rewind = true;
  DestructibleTerrain terrain = hills(settings);
  const Box3d box = world_box(terrain);
  std::vector<Digest> hashes{0, terrain.state().hash};
  const auto dig = [&](std::uint64_t first) {
    for (std::uint64_t i = first; i < first + 80; ++i) {
      terrain.apply(random_operation(i, box, 3));
      hashes.push_back(terrain.state().hash);
    }
  };
  dig(0);
  std::vector<Message> refused;
  for (std::uint64_t i = 500; i < 700; ++i) refused.push_back(encode(random_operation(i, box, 3)));
  refused.push_back(encode(Rewind{5000}));
  EXPECT_THAT(error_of([&] { terrain.apply(refused); }), HasSubstr("cannot be rewound to version 5000"));
  dig(1000);
  for (const std::uint64_t to : {70u, 130u, 161u}) {
    terrain.rewind(to);
    EXPECT_EQ(terrain.state().hash, hashes[to]) << to;
  }
}

TEST(DestructibleTerrain, OpensElevationModels) {
  const TestFolder folder;
  std::ofstream file(folder.path / "hill.asc");
  file << "ncols 40\nnrows 40\nxllcorner 1000\nyllcorner 2000\ncellsize 1\n";
  for (int row = 0; row < 40; ++row) {
    for (int col = 0; col < 40; ++col) file << 30 + 3 * std::sin(0.2 * col) << ' ';
    file << '\n';
  }
  file.close();
  const DestructibleTerrain terrain = DestructibleTerrain::open(folder.path / "hill.asc", {.voxel = 1});
  const auto ground = terrain.snapshot()->ray({1020, 2020, 500}, {0, 0, -1}, 1000);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->point.z, 30 + 3 * std::sin(0.2 * 19.5), 0.2);
  EXPECT_THAT(error_of([&] { DestructibleTerrain::open(folder.path / "none.tif"); }), HasSubstr("none.tif"));
}

TEST(DestructibleTerrain, OpensScenesAndVolumes) {
  const TestFolder folder;
  const fs::path& root = folder.path;
  std::ofstream(root / "a.toml") << R"(
    scene = { voxel = 2.0 }
    terrain = { generator = "coast", width = 120, height = 100 }
    layer = [{ type = "sea-cliff", range = 8.0 }]
  )";
  DestructibleTerrainSettings settings;
  DestructibleTerrain terrain = DestructibleTerrain::open(root / "a.toml", settings);
  const SnapshotPtr now = terrain.snapshot();
  EXPECT_EQ(now->grid().frame().spacing, 2);
  const auto ground = now->ray(now->origin() + Vec3d{0, 0, 500}, {0, 0, -1}, 1000);
  ASSERT_TRUE(ground);
  const scene::BuiltScene scene = scene::build(scene::load_scene(root / "a.toml"));
  EXPECT_NEAR(scene.field_for(surface::Boundary::solid).value(ground->point - scene.terrain.origin), 0, 0.3);
  EXPECT_EQ(now->origin(), scene.terrain.origin);

  io::write_volume(root / "a.tvol", {now->grid(), now->origin(), {}});
  settings.band = 8;
  DestructibleTerrain again = DestructibleTerrain::open(root / "a.tvol", settings);
  EXPECT_EQ(again.state(), terrain.state());
  EXPECT_EQ(again.base(), terrain.base());

  settings.voxel = 0.02;
  try {
    DestructibleTerrain::open(root / "a.toml", settings);
    ADD_FAILURE() << "a terrain that is too large was opened";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("GB"));
  }
  settings.voxel = -1;
  EXPECT_THAT(error_of([&] { DestructibleTerrain::open(root / "a.toml", settings); }),
              HasSubstr("lengths in metres, 0 or more, not -1"));
  EXPECT_THAT(error_of([&] { hills({.floor = std::nan("")}); }), HasSubstr("0 or more, not nan"));
}

}  // namespace
}  // namespace tafoni::runtime
