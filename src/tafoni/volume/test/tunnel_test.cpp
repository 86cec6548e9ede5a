#include "tafoni/volume/tunnel.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

/// In the words of [Ju01 §3]: the least of distance - radius over many points of the axis.
double by_points(const Tunnel& tunnel, Vec3d p) {
  double least = 1e9;
  for (std::size_t i = 0; i + 1 < tunnel.axis.size(); ++i)
    for (int k = 0; k <= 2000; ++k) {
      const double t = k / 2000.0;
      const AxisPoint &a = tunnel.axis[i], &b = tunnel.axis[i + 1];
      const Vec3d q = a.position + (b.position - a.position) * t;
      least = std::min(least, length(p - q) - (a.radius + (b.radius - a.radius) * t));
    }
  return least;
}

TunnelSettings winding(std::uint64_t seed = 3) {
  TunnelSettings s;
  s.radius = 2;
  s.swelling = 0.5;
  s.wander = 0.3;
  s.step = 3;
  s.seed = seed;
  return s;
}

TEST(Tunnel, DistanceIsThatOfTheSweptSpheres) {
  const Tunnel tunnel = fractal_tunnel({0, 0, 0}, {20, 5, 3}, winding());
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const Vec3d p{random.uniform(-6, 26), random.uniform(-6, 12), random.uniform(-6, 9)};
    ASSERT_NEAR(distance(tunnel, p), by_points(tunnel, p), 2e-5);
  }
  const Tunnel swallowed{{{{0, 0, 0}, 5}, {{1, 0, 0}, 1}, {{9, 0, 0}, 1}}};
  for (int i = 0; i < 100; ++i) {
    const Vec3d p{random.uniform(-6, 12), random.uniform(-6, 6), random.uniform(-6, 6)};
    ASSERT_NEAR(distance(swallowed, p), by_points(swallowed, p), 2e-3);
  }
}

/// Every sample by every segment.
ScalarGrid brute_force(ScalarGrid grid, std::span<const Tunnel> tunnels, double reach) {
  const GridFrame frame = grid.frame();
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (int i = 0; i < std::ssize(row); ++i) {
      const Vec3d p = frame.position(first + Vec3i{i, 0, 0});
      for (const Tunnel& t : tunnels) {
        const double d = distance(t, p);
        if (d < reach) row[i] = std::min(row[i], static_cast<float>(d));
      }
    }
  });
  return grid;
}

void expect_same(const ScalarGrid& a, const ScalarGrid& b, double reach) {
  const Vec3i n = a.frame().size;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const double u = a.at({x, y, z}), v = b.at({x, y, z});
        // At the reach itself rounding decides.
        if (std::abs(u - v) > 1e-5) {
          ASSERT_NEAR(std::min(u, v), reach, 1e-5) << x << ' ' << y << ' ' << z;
        }
      }
}

TEST(Tunnel, CarvingEqualsBruteForce) {
  const GridFrame frame{{-8, -10, -9}, 0.5, {70, 45, 47}};
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    TunnelSettings s = winding(seed);
    s.floor = seed % 2 ? 0.6 : 1;
    const Tunnel tunnels[] = {fractal_tunnel({0, 0, 0}, {20, 6, 3}, s),
                              fractal_tunnel({-20, 4, 0}, {4, 0, 2}, s)};  // begins outside of the grid
    const double reach = seed < 2 ? 2 : 1e9;
    ScalarGrid grid(frame, 4);
    // Open already: a slit beside the tunnel, with rock behind it.
    grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
      for (int i = 0; i < std::ssize(row); ++i) {
        const int x = first.x + i;
        if (std::abs(x - 30) < 12 && first.y == 24) row[i] = -5;
        if (first.z > 40) row[i] = -1;
      }
    });
    const ScalarGrid truth = brute_force(grid, tunnels, reach);
    ScalarGrid carved = grid;
    const SampleBox changed = carve(carved, tunnels, reach);
    expect_same(carved, truth, reach);
    EXPECT_FALSE(changed.empty());
    const Vec3i n = frame.size;
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
          // Open space only grows.
          ASSERT_LE(carved.at({x, y, z}), grid.at({x, y, z}));
          if (x < changed.lo.x || x > changed.hi.x || y < changed.lo.y || y > changed.hi.y ||
              z < changed.lo.z || z > changed.hi.z) {
            ASSERT_EQ(carved.at({x, y, z}), grid.at({x, y, z}));
          }
        }
    ScalarGrid again = carved;
    EXPECT_TRUE(carve(again, tunnels, reach).empty());
    EXPECT_TRUE(again == carved);
  }
}

TEST(Tunnel, MemoryFollowsTheTunnelNotTheGrid) {
  ScalarGrid grid({{0, 0, 0}, 0.25, {4096, 4096, 2048}}, 1);
  TunnelSettings s;
  const Tunnel tunnel = fractal_tunnel({400, 500, 200}, {600, 500, 210}, s);
  carve(grid, {&tunnel, 1}, 1);
  EXPECT_LT(grid.full_chunks(), 400u);
  EXPECT_LT(grid.value({400, 500, 200}), -1.5f);
}

TEST(Tunnel, AxisKeepsItsEndsStepsRadiiAndSlope) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    TunnelSettings s = winding(seed);
    s.slope = 0.5;
    s.climb = 1;
    const Vec3d from{3, 4, 5}, to{60, -10, 17};
    const Tunnel tunnel = fractal_tunnel(from, to, s);
    ASSERT_EQ(tunnel.axis.front().position, from);
    ASSERT_EQ(tunnel.axis.back().position, to);
    for (std::size_t i = 0; i + 1 < tunnel.axis.size(); ++i) {
      const Vec3d d = tunnel.axis[i + 1].position - tunnel.axis[i].position;
      ASSERT_LE(std::abs(d.z), 0.5001 * std::hypot(d.x, d.y) + 1e-9);
      ASSERT_GE(tunnel.axis[i].radius, 0.999);
      ASSERT_LE(tunnel.axis[i].radius, 3.001);
    }
    ASSERT_GT(length(tunnel), length(to - from));
  }
  TunnelSettings straight = winding();
  straight.wander = 0;
  EXPECT_NEAR(length(fractal_tunnel({0, 0, 0}, {50, 0, 0}, straight)), 50, 1e-9);
}

TEST(Tunnel, OneCanStandOnAFloor) {
  TunnelSettings s = winding();
  s.floor = 0.5;
  s.wander = 0, s.swelling = 0;
  const Tunnel tunnel = fractal_tunnel({0, 0, 0}, {20, 0, 0}, s);
  for (double y : {-1.0, 0.0, 1.0}) {
    EXPECT_NEAR(distance(tunnel, {10, y, -1}), 0, 1e-9);
    EXPECT_LT(distance(tunnel, {10, y, -0.9}), 0);
    EXPECT_GT(distance(tunnel, {10, y, -1.1}), 0);
  }
}

TEST(Tunnel, RefusesWhatIsWrong) {
  TunnelSettings s;
  s.radius = 0;
  EXPECT_THAT(error_of([&] {
                fractal_tunnel({}, {1, 0, 0}, s);
              }),
              HasSubstr("radius and step must be positive lengths in metres"));
  s = {};
  s.step = 0;
  EXPECT_THAT(error_of([&] {
                fractal_tunnel({}, {1, 0, 0}, s);
              }),
              HasSubstr("radius and step must be positive lengths in metres"));
}

}  // namespace
}  // namespace tafoni::volume
