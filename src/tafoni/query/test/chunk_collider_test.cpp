#include "tafoni/query/chunk_collider.h"

#include <cmath>
#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/query/mesh_collider.h"

namespace tafoni::query {
namespace {

struct Order {
  bool operator()(Vec3i a, Vec3i b) const { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }
};

/// A rough ground with hollows, cut off by the frame on all sides, of 3 x 3 x 2 chunks.
struct Ground {
  volume::ScalarGrid grid{{{-17.3, -16.1, -15.2}, 0.5, {70, 68, 40}}, 0};
  surface::GridMesher mesher{{surface::Boundary::solid, false}};
  std::map<Vec3i, std::unique_ptr<ChunkShape>, Order> shapes;

  Ground() {
    grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
      for (std::size_t i = 0; i < row.size(); ++i) {
        const Vec3d p = grid.frame().position(first + Vec3i{static_cast<int>(i), 0, 0});
        row[i] = static_cast<float>(3 * std::sin(0.5 * p.x) * std::sin(0.4 * p.y + 1) * std::cos(0.6 * p.z) -
                                    0.4 * p.z);
      }
    });
    mesher.update(grid, {});
    for (Vec3i c : mesher.chunks()) shapes[c] = std::make_unique<ChunkShape>(mesher.chunk(c));
  }
  ChunkCollider collider() const {
    return {grid, [this](Vec3i c) -> const ChunkShape* {
              const auto found = shapes.find(c);
              return found == shapes.end() ? nullptr : found->second.get();
            }};
  }
};

TEST(ChunkCollider, AgreesWithTheWholeMesh) {
  const Ground ground;
  const ChunkCollider chunks = ground.collider();
  const MeshCollider whole(ground.mesher.assemble());
  ASSERT_GT(ground.shapes.size(), 10u);
  Random r(4);
  const Box3d box = ground.grid.frame().box().grown(2);
  const auto place = [&] {
    const double x = r.uniform(box.lo.x, box.hi.x), y = r.uniform(box.lo.y, box.hi.y);
    return Vec3d{x, y, r.uniform(box.lo.z, box.hi.z)};
  };
  int rock = 0, hits = 0, overlaps = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d p = place(), way = place() - p;
    rock += whole.solid(p);
    EXPECT_EQ(chunks.solid(p), whole.solid(p)) << p.x << " " << p.y << " " << p.z;

    const auto a = chunks.ray(p, way, 100), b = whole.ray(p, way, 100);
    ASSERT_EQ(a.has_value(), b.has_value()) << i;
    if (a) {
      ++hits;
      EXPECT_NEAR(a->distance, b->distance, 1e-9);
      EXPECT_EQ(a->from_rock, b->from_rock);
    }
    const auto near = chunks.closest(p, 50), near_too = whole.closest(p, 50);
    ASSERT_TRUE(near && near_too);
    EXPECT_NEAR(near->distance, near_too->distance, 1e-9) << i;

    const Capsule shape(p, p + Vec3d{0, 0, 0.8}, r.uniform(0.1, 1.5));
    overlaps += whole.overlaps(shape);
    EXPECT_EQ(chunks.overlaps(shape), whole.overlaps(shape)) << i;
    const auto sweep = chunks.sweep(shape, way), sweep_too = whole.sweep(shape, way);
    ASSERT_EQ(sweep.has_value(), sweep_too.has_value()) << i;
    if (sweep) {
      EXPECT_NEAR(sweep->time, sweep_too->time, 1e-9) << i;
    }
  }
  EXPECT_GT(rock, 500);
  EXPECT_GT(hits, 1000);
  EXPECT_GT(overlaps, 500);
}

TEST(ChunkCollider, BeyondTheFrameIsAir) {
  const Ground ground;
  const ChunkCollider collider = ground.collider();
  const Box3d box = ground.grid.frame().box();
  EXPECT_TRUE(collider.solid(box.lo + Vec3d{5.01, 5.01, 0.01}));
  EXPECT_FALSE(collider.solid(box.lo + Vec3d{5.01, 5.01, -0.1}));
  EXPECT_FALSE(collider.solid({1e12, 0, 0}));
  EXPECT_FALSE(collider.ray(box.lo - Vec3d{5, 5, 5}, {-1, 0, 0}, 1e9));
}

}  // namespace
}  // namespace tafoni::query
