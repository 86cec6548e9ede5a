// One terrain, several threads: some dig, some look.

#include <atomic>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/runtime/test/operations.h"
#include "tafoni/runtime/test/rocks.h"

namespace tafoni::runtime {
namespace {

/// What a renderer does: keeps its own copy of every chunk up to date.
class Mirror {
 public:
  void follow(const DestructibleTerrain& terrain) {
    const auto changes = terrain.changes_since(version_);
    EXPECT_GE(changes.version, version_);
    version_ = changes.version;
    for (const surface::ChunkChange& change : changes.chunks) {
      const TerrainChunk chunk = terrain.chunk(change.chunk);
      EXPECT_GE(chunk.version, change.version);  // or of an edit since
      EXPECT_GE(chunk.version, last_[change.chunk]);
      last_[change.chunk] = chunk.version;
      chunks_[change.chunk] = chunk.mesh;
    }
  }
  void expect_same(const Snapshot& snapshot) const {
    EXPECT_EQ(version_, snapshot.version());
    for (const Vec3i c : snapshot.chunks()) EXPECT_TRUE(chunks_.contains(c));
    for (const auto& [c, mesh] : chunks_) EXPECT_TRUE(same(*mesh, *snapshot.chunk(c).mesh));
  }

 private:
  std::uint64_t version_ = 0;
  std::map<Vec3i, std::uint64_t, surface::ChunkOrder> last_;
  std::map<Vec3i, surface::GridChunkPtr, surface::ChunkOrder> chunks_;
};

/// What players do: everything that a snapshot says must fit together.
void look(const Snapshot& now, Random& r) {
  const double spacing = now.grid().frame().spacing;
  const double x = r.uniform(-20, 20), y = r.uniform(-20, 20);
  const auto hit = now.ray({x, y, 11}, {0, 0, -1}, 40);
  if (!hit) return;
  EXPECT_NEAR(now.grid().value(now.to_local(hit->point)), 0, spacing);
  EXPECT_TRUE(now.solid(hit->point - hit->normal * 1e-4));
  EXPECT_FALSE(now.solid(hit->point + hit->normal * 1e-4));
  const query::Sphere ball{hit->point + hit->normal * 2, 0.5};
  if (!now.overlaps(ball)) {
    const query::Slide slide = now.slide(ball, {1, 0, -2});
    EXPECT_FALSE(now.overlaps(query::Sphere{ball.center + slide.moved, ball.radius}));
  }
  const auto chunks = now.chunks();
  const TerrainChunk chunk = now.chunk(chunks[r.below(chunks.size())]);
  EXPECT_LE(chunk.version, now.version());
  const Box3d box = now.grid().frame().box();  // its walls lie beyond
  for (const Vec3f& p : chunk.mesh->positions)
    if (box.contains(to_double(p))) {
      EXPECT_NEAR(now.grid().value(to_double(p)), 0, spacing) << chunk.version;
    }
}

/// ThreadSanitizer does not see how TBB's threads wait for one another, so that every loop looks like a race.
/// With loops on one thread, what it reports of this test is real.
struct LoopsThatSanitizersSee {
#if defined(__SANITIZE_THREAD__)
  LoopsThatSanitizersSee() {
    set_thread_count(1);
  }
  ~LoopsThatSanitizersSee() {
    set_thread_count(0);
  }
#endif
};

TEST(Threads, DiggingAndLookingAtTheSameTime) {
  [[maybe_unused]] const LoopsThatSanitizersSee loops;
  DestructibleTerrain terrain = hills({});
  const Box3d box = world_box(terrain);
  constexpr std::uint64_t edits = 120, diggers = 2;
  std::atomic<std::uint64_t> digging{diggers};
  std::vector<std::thread> threads;
  for (std::uint64_t d = 0; d < diggers; ++d)
    threads.emplace_back([&, d] {
      std::uint64_t last = 0;
      for (std::uint64_t i = 0; i < edits; ++i) {
        const std::uint64_t version = terrain.apply(random_operation(1000 * d + i, box, 3));
        EXPECT_GT(version, last);
        last = version;
      }
      --digging;
    });
  Mirror mirrors[2];
  for (std::uint64_t l = 0; l < 2; ++l)
    threads.emplace_back([&, l] {
      Random r(31, l);
      std::uint64_t last = 0;
      while (digging) {
        const SnapshotPtr now = terrain.snapshot();
        EXPECT_GE(now->version(), last);
        last = now->version();
        look(*now, r);
        mirrors[l].follow(terrain);
      }
    });
  threads.emplace_back([&] {
    while (digging) {
      const std::size_t made = terrain.edits_since(1).size();
      EXPECT_LE(made + 1, terrain.state().version);
    }
  });
  for (std::thread& t : threads) t.join();

  EXPECT_EQ(terrain.version(), 1 + diggers * edits);
  for (Mirror& mirror : mirrors) {
    mirror.follow(terrain);
    mirror.expect_same(*terrain.snapshot());
  }
  DestructibleTerrain again = hills({});
  for (const Message& message : terrain.edits_since(1)) again.apply({&message, 1});
  EXPECT_EQ(again.state(), terrain.state());
  EXPECT_THAT(differing(*again.snapshot(), *terrain.snapshot()), testing::ElementsAre());
}

}  // namespace
}  // namespace tafoni::runtime
