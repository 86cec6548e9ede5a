// Distances to a surface are what brute force over its triangles gives, on the side where the samples are.

#include "tafoni/surface/distances.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/surface/grid_mesher.h"
#include "tafoni/volume/test/grid_of.h"

namespace tafoni::surface {
namespace {

using testing::HasSubstr;
using volume::grid_of;
using volume::GridFrame;
using volume::Precision;
using volume::SampleBox;
using volume::ScalarGrid;

/// The nearest point of a triangle by a search that knows nothing of regions: barycentric, ever finer.
double slow_distance(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  double best = std::numeric_limits<double>::infinity(), u0 = 0, v0 = 0, step = 0.25;
  for (int round = 0; round < 14; ++round, step /= 2) {
    double u1 = u0, v1 = v0;
    for (int i = -4; i <= 4; ++i)
      for (int k = -4; k <= 4; ++k) {
        const double u = std::clamp(u0 + i * step, 0.0, 1.0), v = std::clamp(v0 + k * step, 0.0, 1.0 - u);
        const double d = length(a + (b - a) * u + (c - a) * v - p);
        if (d < best) best = d, u1 = u, v1 = v;
      }
    u0 = u1, v0 = v1;
  }
  return best;
}

void for_samples(const ScalarGrid& grid, const std::function<void(Vec3i)>& visit) {
  const Vec3i n = grid.frame().size;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) visit({x, y, z});
}

TEST(Distances, AreThoseOfBruteForce) {
  // Noise, so that all cases of cells come up, over two chunks and a part of one; some samples far beyond.
  const GridFrame frame{{-3, 5, 40}, 0.5, {41, 9, 8}};
  Random random(3);
  const ScalarGrid grid = grid_of(frame, [&](Vec3d p) {
    return p.x > 10 ? -8.0 : p.x < 1 ? 3.0 : random.uniform(-1, 0.2) * (p.y > 7 ? 100 : 1);
  });
  GridMesher mesher;
  mesher.update(grid, {});
  const mesh::Mesh mesh = mesher.assemble();
  ASSERT_GT(mesh.triangles.size(), 300u);
  const double reach = 1.6;
  const ScalarGrid d = distances(grid, reach, Precision::single);
  EXPECT_EQ(d.frame(), frame);
  for_samples(grid, [&](Vec3i s) {
    if ((s.x + s.y + s.z) % 3 != 0) return;  // brute force is slow
    double truth = reach;
    const Vec3d p = frame.position(s);
    for (const auto& t : mesh.triangles) {
      Vec3d v[3];
      for (int k = 0; k < 3; ++k) v[k] = mesh.origin + to_double(mesh.positions[t[k]]);
      const Vec3d middle = (v[0] + v[1] + v[2]) * (1.0 / 3);
      if (length(middle - p) < truth + 1) truth = std::min(truth, slow_distance(p, v[0], v[1], v[2]));
    }
    ASSERT_NEAR(d.at(s), grid.at(s) > 0 ? truth : -truth, 1e-3) << s.x << " " << s.y << " " << s.z;
  });
}

TEST(Distances, OfAPlaneAreExactHoweverSteepTheFieldIs) {
  const GridFrame frame{{0, 0, 0}, 2, {70, 40, 40}};
  const Vec3d normal = Vec3d{1, 2, 5} * (1 / std::sqrt(30.0));
  for (const double steepness : {0.01, 1.0, 30.0}) {
    const auto distance = [&](Vec3d p) { return dot(Vec3d{60, 40, 37.3} - p, normal); };
    const ScalarGrid d =
        distances(grid_of(frame, [&](Vec3d p) { return steepness * distance(p); }), 8, Precision::single);
    int near = 0;
    for_samples(d, [&](Vec3i s) {
      const double truth = distance(frame.position(s));
      ASSERT_EQ(d.at(s) > 0, truth > 0);
      // Where the plane leaves the frame, what would be nearest is missing.
      const Vec3i n = frame.size;
      if (s.x < 5 || s.y < 5 || s.z < 5 || s.x > n.x - 6 || s.y > n.y - 6 || s.z > n.z - 6) return;
      ASSERT_NEAR(d.at(s), std::clamp(truth, -8.0, 8.0), 1e-4 * steepness + 1e-3);
      near += std::abs(truth) < 8;
    });
    EXPECT_GT(near, 5000);
  }
}

TEST(Distances, KeepEachSampleOnItsSideAlsoInHalfPrecision) {
  Random random(9);
  const ScalarGrid grid = grid_of({{0, 0, 0}, 1, {40, 34, 33}}, [&](Vec3d) { return random.uniform(-1, 1); });
  const ScalarGrid d = distances(grid, 3, Precision::half);
  EXPECT_EQ(d.precision(), Precision::half);
  for_samples(grid, [&](Vec3i s) { ASSERT_EQ(d.at(s) > 0, grid.at(s) > 0); });
}

TEST(Distances, TakeMemoryOnlyNearTheSurface) {
  const GridFrame frame{{0, 0, 0}, 1, {200, 200, 200}};
  const ScalarGrid d = distances(grid_of(frame, [](Vec3d p) { return 45.5 - p.z; }), 4, Precision::single);
  EXPECT_EQ(d.full_chunks(), 7u * 7u);  // z from 32 to 63
  EXPECT_EQ(d.at({0, 0, 0}), 4);
  EXPECT_EQ(d.at({199, 0, 199}), -4);
}

TEST(Distances, DoNotDependOnThreads) {
  const GridFrame frame{{0, 0, 0}, 1, {70, 70, 70}};
  const ScalarGrid grid = grid_of(frame, [](Vec3d p) { return 30 - length(p - Vec3d{35, 35, 35}); });
  set_thread_count(1);
  const ScalarGrid one = distances(grid, 5, Precision::single);
  set_thread_count(0);
  EXPECT_TRUE(one == distances(grid, 5, Precision::single));
}

TEST(Distances, RefuseWhatTheyCannotReach) {
  const ScalarGrid grid({{0, 0, 0}, 2, {9, 9, 9}}, -1);
  EXPECT_THAT(error_of([&] { distances(grid, 28.1, Precision::single); }), HasSubstr("at most 14 cells"));
  EXPECT_THAT(error_of([&] { distances(grid, 0, Precision::single); }), HasSubstr("above 0"));
  EXPECT_EQ(distances(grid, 28, Precision::single).at({4, 4, 4}), -28);
}

}  // namespace
}  // namespace tafoni::surface
