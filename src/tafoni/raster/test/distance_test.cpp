#include "tafoni/raster/distance.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

namespace tafoni::raster {
namespace {

/// The definition: the least distance from the centre to a box of the other kind.
double brute(const Grid<std::uint8_t>& mask, int col, int row, double dx, double dy) {
  const bool inside = mask.at(col, row) != 0;
  double best = std::numeric_limits<double>::infinity();
  for (int r = 0; r < mask.height(); ++r)
    for (int c = 0; c < mask.width(); ++c) {
      if ((mask.at(c, r) != 0) == inside) continue;
      const double x = std::max(std::abs(c - col) - 0.5, 0.0) * dx;
      const double y = std::max(std::abs(r - row) - 0.5, 0.0) * dy;
      best = std::min(best, std::hypot(x, y));
    }
  return inside ? best : -best;
}

/// A cheap pseudo-random byte from three numbers.
unsigned mix(unsigned a, unsigned b, unsigned c) {
  unsigned h = a * 2654435761u ^ b * 2246822519u ^ c * 3266489917u;
  h ^= h >> 15;
  h *= 2246822519u;
  h ^= h >> 13;
  return h & 255u;
}

TEST(SignedDistance, EqualsBruteForceOnRandomMasks) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const int width = 1 + mix(seed, 1, 1) % 37, height = 1 + mix(seed, 2, 1) % 29;
    const double dx = seed % 3 == 0 ? 10 : 1, dy = seed % 2 == 0 ? 25 : 1;
    const unsigned share = mix(seed, 3, 1);
    Grid<std::uint8_t> mask(width, height);
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) mask.at(c, r) = mix(c, r, seed) > share;
    const Grid<float> got = signed_distance(mask, dx, dy);
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) {
        const double want = brute(mask, c, r, dx, dy);
        if (std::isinf(want)) {
          EXPECT_EQ(got.at(c, r), static_cast<float>(want));
        } else {
          ASSERT_NEAR(got.at(c, r), want, 1e-5 * std::abs(want)) << seed << ' ' << c << ' ' << r;
        }
      }
  }
}

TEST(SignedDistance, IsZeroHalfwayBetweenNeighboursOfBothKinds) {
  Grid<std::uint8_t> mask(8, 1);
  for (int c = 4; c < 8; ++c) mask.at(c, 0) = 1;
  const Grid<float> d = signed_distance(mask, 10, 1);
  EXPECT_FLOAT_EQ(d.at(3, 0), -5);
  EXPECT_FLOAT_EQ(d.at(4, 0), 5);
  EXPECT_FLOAT_EQ(d.at(7, 0), 35);
}

TEST(SignedDistance, SquareWithAHole) {
  const std::vector<std::vector<Vec2d>> rings{{{10, 10}, {90, 10}, {90, 90}, {10, 90}},
                                              {{40, 40}, {60, 40}, {60, 60}, {40, 60}}};
  const Placement placement{0, 100, 1, 1};
  const Grid<float> d = signed_distance(rings, placement, 100, 100, 200);
  for (int row = 0; row < 100; ++row)
    for (int col = 0; col < 100; ++col) {
      const Vec2d p = placement.center(col, row);
      const auto box = [&](double lo, double hi) {  // negative inside
        const double x = std::max(lo - p.x, p.x - hi), y = std::max(lo - p.y, p.y - hi);
        return std::min(std::max(x, y), 0.0) + std::hypot(std::max(x, 0.0), std::max(y, 0.0));
      };
      ASSERT_NEAR(d.at(col, row), std::min(-box(10, 90), box(40, 60)), 1e-4) << col << ' ' << row;
    }
}

TEST(SignedDistance, PolygonBandIsExactAndBeyondItAtLeastTheBand) {
  std::vector<Vec2d> ring;
  for (int i = 0; i < 97; ++i) {
    const double a = 2 * 3.14159265358979 * i / 97, r = 30 + 8 * std::sin(5 * a);
    ring.push_back({500'000 + r * std::cos(a), 5'900'000 + r * std::sin(a)});
  }
  const Placement placement{500'000 - 60, 5'900'000 + 60, 1, 2};
  const Grid<float> all = signed_distance({ring}, placement, 120, 60, 1000);
  const Grid<float> band = signed_distance({ring}, placement, 120, 60, 6);
  for (int row = 0; row < 60; ++row)
    for (int col = 0; col < 120; ++col) {
      double want = 1e9;
      const Vec2d p = placement.center(col, row);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2d a = ring[i], b = ring[(i + 1) % ring.size()], e = b - a, t = p - a;
        const double s = std::clamp((t.x * e.x + t.y * e.y) / (e.x * e.x + e.y * e.y), 0.0, 1.0);
        want = std::min(want, std::hypot(t.x - s * e.x, t.y - s * e.y));
      }
      ASSERT_NEAR(std::abs(all.at(col, row)), want, 1e-4);
      ASSERT_EQ(std::signbit(all.at(col, row)), std::signbit(band.at(col, row)));
      if (want < 6) {
        ASSERT_NEAR(std::abs(band.at(col, row)), want, 1e-4);
      } else {
        ASSERT_GE(std::abs(band.at(col, row)), 6);
      }
    }
}

}  // namespace
}  // namespace tafoni::raster
