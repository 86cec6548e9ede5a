#include "tafoni/io/impl/polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"

namespace tafoni::io::impl {
namespace {

struct Cut {
  std::size_t triangles = 0;
  double area = 0, absolute = 0;  ///< signed about the polygon's own normal, and without signs
};

/// Turned and moved about in space, and begun at each of its corners.
Cut cut(const std::vector<Vec2d>& flat, std::size_t first, int axis) {
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> polygon;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const Vec2d p = flat[(first + i) % flat.size()];
    const double w = 0.3 * p.x - 0.2 * p.y;
    positions.push_back(axis == 0 ? Vec3d{p.x, p.y, w} : axis == 1 ? Vec3d{w, p.x, p.y} : Vec3d{p.y, w, p.x});
    positions.back() += Vec3d{4e5, 5e6, 100};
    polygon.push_back(static_cast<std::uint32_t>(i));
  }
  Vec3d normal;
  for (std::size_t i = 2; i < positions.size(); ++i)
    normal += cross(positions[i - 1] - positions[0], positions[i] - positions[0]);
  Cut out;
  PolygonCutter cutter;
  for (const auto& [a, b, c] : cutter.cut(polygon, positions)) {
    const Vec3d facet = cross(positions[b] - positions[a], positions[c] - positions[a]);
    ++out.triangles;
    out.area += dot(facet, normal) / length(normal) / 2;
    out.absolute += length(facet) / 2;
  }
  return out;
}

TEST(PolygonCutter, TrianglesCoverAConcavePolygonOnce) {
  const std::vector<Vec2d> l = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};
  const std::vector<Vec2d> arrow = {{0, 0}, {2, 4}, {0, 3}, {-2, 4}};
  std::vector<Vec2d> star, comb = {{0, 0}};
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const double angle = 2 * std::numbers::pi * i / 60, r = random.uniform(1, 4);
    star.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  comb.push_back({20, 0});
  for (int i = 10; i > 0; --i) {
    comb.push_back({2.0 * i, 5});
    comb.push_back({2.0 * i - 1, 1});
  }
  for (const auto& polygon : {l, arrow, star, comb})
    for (std::size_t first = 0; first < polygon.size(); ++first)
      for (int axis = 0; axis < 3; ++axis)
        for (const bool turned : {false, true}) {
          std::vector<Vec2d> p = polygon;
          if (turned) std::reverse(p.begin(), p.end());
          const Cut made = cut(p, first, axis);
          EXPECT_EQ(made.triangles, p.size() - 2);
          EXPECT_NEAR(made.absolute, made.area, 1e-6) << p.size() << ' ' << first << ' ' << axis;
        }
}

TEST(PolygonCutter, WhatIsConvexOrUnknownIsAFan) {
  PolygonCutter cutter;
  const std::vector<Vec3d> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> known = {0, 1, 2, 3}, unknown = {0, 2, 9, 1};
  const auto fan = std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}};
  for (const auto& polygon : {known, unknown}) {
    const auto made = cutter.cut(polygon, square);
    EXPECT_TRUE(std::equal(made.begin(), made.end(), fan.begin(), fan.end()));
  }
  EXPECT_TRUE(cutter.cut(std::vector<std::uint32_t>{0, 1}, square).empty());
}

TEST(PolygonCutter, PolygonsThatMeetOrCrossThemselvesEnd) {
  Random random(5);
  PolygonCutter cutter;
  for (int run = 0; run < 300; ++run) {
    std::vector<Vec3d> positions;
    std::vector<std::uint32_t> polygon;
    for (std::uint32_t i = 0; i < 40; ++i) {
      positions.push_back({std::floor(random.uniform(0, 4)), std::floor(random.uniform(0, 4)),
                           run % 3 ? 0 : random.uniform()});
      polygon.push_back(i);
    }
    EXPECT_EQ(cutter.cut(polygon, positions).size(), 38u);
  }
}

}  // namespace
}  // namespace tafoni::io::impl
