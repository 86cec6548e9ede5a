#include "tafoni/volume/prism_convert.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/field/each_point.h"
#include "tafoni/math/draw.h"
#include "tafoni/raster/sampled.h"
#include "tafoni/volume/sample.h"
#include "tafoni/volume/test/random_tools.h"

namespace tafoni::volume {
namespace {

raster::Raster hills() {
  raster::Raster r = raster::sampled(60, 80, {-10, 20, 0.5, 0.25},
                                     [](double x, double y) { return 3 + std::sin(0.5 * x) + 0.1 * y; });
  r.values.at(7, 5) = raster::no_data;
  return r;
}

TEST(PrismConvert, HeightsBecomeColumns) {
  const raster::Raster r = hills();
  const PrismFields fields = prism_from(r, -2);
  EXPECT_EQ(fields.layers(), 1);
  for (int row = 0; row < 80; ++row)
    for (int col = 0; col < 60; ++col) {
      const Vec2d at = r.placement.center(col, row);
      const int j = 79 - row;
      EXPECT_DOUBLE_EQ(fields.frame().x(col), at.x);
      EXPECT_DOUBLE_EQ(fields.frame().y(j), at.y);
      const auto matter = fields.column(col, j);
      if (col == 7 && row == 5) {
        EXPECT_TRUE(matter.empty());
        continue;
      }
      ASSERT_EQ(matter.size(), 1u);
      EXPECT_EQ(matter[0].bottom, 0);
      EXPECT_NEAR(matter[0].top - 2, r.values.at(col, row), 1e-5);
    }
  // A base over the ground.
  EXPECT_EQ(prism_from(r, 100).layers(), 0);
  EXPECT_EQ(error_of([&] { prism_from(raster::Raster{}, 0); }),
            "a prism-field needs 2 x 2 pixels of ground; this has 0 x 0");
}

/// A ball with a ball-shaped hollow, in the air.
class Shell final : public field::Function {
 public:
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field::each_point(points, out, [](Vec3d p) {
      const double r = length(p - Vec3d{1, 2, 3});
      return std::min(5 - r, r - 2.5);
    });
  }
  Interval range(const Box3d&) const override { return {-100, 100}; }
};

void expect_shell(const PrismFields& fields, double tolerance) {
  int hollow = 0;
  for (int j = 0; j < fields.frame().ny; ++j)
    for (int i = 0; i < fields.frame().nx; ++i) {
      const double d = std::hypot(fields.frame().x(i) - 1, fields.frame().y(j) - 2);
      const auto matter = fields.column(i, j);
      // Near the rims matter and air are thinner than a step.
      if (std::abs(d - 5) < 0.15 || std::abs(d - 2.5) < 0.15) continue;
      ASSERT_EQ(matter.size(), d > 5 ? 0u : d > 2.5 ? 1u : 2u) << d;
      if (matter.empty()) continue;
      const double half = std::sqrt(25 - d * d), z = fields.frame().origin.z;
      EXPECT_NEAR(z + matter.front().bottom, 3 - half, tolerance);
      EXPECT_NEAR(z + matter.back().top, 3 + half, tolerance);
      if (matter.size() < 2) continue;
      ++hollow;
      EXPECT_NEAR(z + matter[0].top, 3 - std::sqrt(2.5 * 2.5 - d * d), tolerance);
    }
  EXPECT_GT(hollow, 20);
}

TEST(PrismConvert, FieldsBecomeColumnsByRoots) {
  const auto field = field::compile(field::function(std::make_shared<Shell>()));
  expect_shell(prism_from(field, {{-5, -4, -3}, {7, 8, 9}}, 0.5), 1e-3);
}

TEST(PrismConvert, GridsBecomeColumnsByTheirTrilinearRoots) {
  const auto field = field::compile(field::function(std::make_shared<Shell>()));
  const ScalarGrid grid = sample(field, frame_over({{-5, -4, -3}, {7, 8, 9}}, 0.25));
  const PrismFields fields = prism_from(grid);
  expect_shell(fields, 0.05);
  for (int j = 0; j < fields.frame().ny; ++j)
    for (int i = 0; i < fields.frame().nx; ++i)
      for (const Matter& m : fields.column(i, j)) {
        const ColumnFrame& f = fields.frame();
        const auto at = [&](float z) { return grid.value({f.x(i), f.y(j), f.origin.z + z}); };
        EXPECT_NEAR(at(m.bottom), 0, 1e-5);
        EXPECT_NEAR(at(m.top), 0, 1e-5);
      }
}

TEST(PrismConvert, WhatTheFrameCutsEndsThere) {
  ScalarGrid grid({{0, 0, 10}, 0.5, {4, 4, 9}}, 1.0f);
  const PrismFields fields = prism_from(grid);
  EXPECT_EQ(fields.column(2, 1), (std::vector<Matter>{{0, 4}}));
}

PrismFields dug(Random& random, int tools) {
  PrismFields fields = prism_box({{3, -4, 10}, 0.5, 0.75, 31, 25}, 8, 16);
  const Box3d room{{3, -4, 8}, {18, 14, 16}};
  for (int n = 0; n < tools; ++n)
    fields.apply(random_tool(random, room), random.uniform() < 0.7 ? Edit::remove : Edit::add);
  return fields;
}

TEST(PrismFunction, AgreesWithTheColumns) {
  Random random(31);
  for (int round = 0; round < 20; ++round) {
    const PrismFields fields = dug(random, round);
    const field::FunctionPtr f = as_function(fields, {.reach = 3});
    const ColumnFrame& frame = fields.frame();
    std::int64_t wrong = 0, all = 0;
    for (int n = 0; n < 4000; ++n) {
      const int i = 1 + draw_index(random, 29), j = 1 + draw_index(random, 23);
      const double z = random.uniform(7, 17);
      // Beside the column, so that no wall that ends there makes it the surface.
      const Vec3d p{frame.x(i) + 1e-7, frame.y(j) + 1e-7, z};
      float value;
      f->values({&p, 1}, {&value, 1});
      bool in = false;
      for (const Matter& m : fields.column(i, j)) {
        const double bottom = frame.origin.z + m.bottom, top = frame.origin.z + m.top;
        if (std::abs(z - bottom) < 1e-3 || std::abs(z - top) < 1e-3) in = value > 0;
        in = in || (z > bottom && z < top);
      }
      ++all;
      // A cell may lack what its column has (dead points); it never has what the column lacks.
      if (value > 1e-3f) {
        EXPECT_TRUE(in) << round << ": " << i << ", " << j << ", " << z;
      }
      wrong += in != (value > 0);
    }
    EXPECT_LE(wrong, all / 8) << round;
  }
}

TEST(PrismFunction, IsTheDistanceToPlanesAndWalls) {
  const field::FunctionPtr f = as_function(prism_box({{0, 0, 0}, 1, 1, 11, 11}, 0, 8), {.reach = 3});
  const auto at = [&](Vec3d p) {
    float v;
    f->values({&p, 1}, {&v, 1});
    return v;
  };
  EXPECT_FLOAT_EQ(at({5, 5, 7}), 1);
  EXPECT_FLOAT_EQ(at({5, 5, 10}), -2);
  EXPECT_FLOAT_EQ(at({5, 5, 4}), 3);
  EXPECT_FLOAT_EQ(at({0.25, 5, 4}), 0.25f);
  EXPECT_FLOAT_EQ(at({-0.5, 5, 4}), -0.5f);
  EXPECT_FLOAT_EQ(at({-3, -4, 4}), -3);
  // On a slope of 3 in 4.
  const raster::Raster slope =
      raster::sampled(20, 20, {0, 20, 1, 1}, [](double x, double) { return 0.75 * x; });
  const field::FunctionPtr g = as_function(prism_from(slope, -10), {.reach = 3, .floor = -10});
  const Vec3d p{10, 10, 7.5 + 1.25};
  float v;
  g->values({&p, 1}, {&v, 1});
  EXPECT_FLOAT_EQ(v, -1);
  const Vec3d deep{10, 10, -500};
  g->values({&deep, 1}, {&v, 1});
  EXPECT_FLOAT_EQ(v, 3);
}

TEST(PrismFunction, RangesEncloseAndPrune) {
  Random random(32);
  int pruned = 0, boxes = 0;
  for (int round = 0; round < 12; ++round) {
    const field::FunctionPtr f =
        as_function(dug(random, 2 * round), {.reach = 3, .rounding = round % 2 ? 0.7 : 0});
    for (int n = 0; n < 300; ++n) {
      const Vec3d lo = random_point(random, {{1, -6, 5}, {20, 16, 18}});
      const Box3d box{lo, lo + random_point(random, {{0, 0, 0}, {2, 2, 2}})};
      const Interval range = f->range(box);
      ++boxes;
      pruned += range.lo > 0 || range.hi <= 0;
      for (int s = 0; s < 60; ++s) {
        const Vec3d p = random_point(random, box);
        float v;
        f->values({&p, 1}, {&v, 1});
        ASSERT_GE(v, range.lo) << round;
        ASSERT_LE(v, range.hi) << round;
      }
    }
  }
  EXPECT_GT(pruned, boxes / 4);
}

// Else a tree of the leaf alone would have no end.
TEST(PrismFunction, IsAirFarAway) {
  Random random(34);
  for (int round = 0; round < 5; ++round) {
    const field::FunctionPtr f =
        as_function(dug(random, 10 * round), {.reach = 3, .rounding = round % 2 ? 0.7 : 0});
    for (const Vec3d way : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      const Vec3d at = Vec3d{10, 5, 12} + way * 60;
      const Interval range = f->range({at - Vec3d{20, 20, 20}, at + Vec3d{20, 20, 20}});
      EXPECT_LT(range.hi, 0) << way.x << ", " << way.y << ", " << way.z;
    }
  }
}

/// Metres from the axis to the wall of a shaft at (10, 10), at elevation 5.
double wall_at(const field::Function& f, double angle) {
  double lo = 1, hi = 9;
  for (int k = 0; k < 30; ++k) {
    const double r = 0.5 * (lo + hi);
    const Vec3d p{10 + r * std::cos(angle), 10 + r * std::sin(angle), 5};
    float v;
    f.values({&p, 1}, {&v, 1});
    (v > 0 ? hi : lo) = r;
  }
  return lo;
}

/// The tangent by which walls of round shafts turn away from round, root of the mean square.
double unevenness(double rounding) {
  constexpr int n = 400;
  double sum = 0;
  for (const double radius : {3.1, 4.4, 5.3}) {
    PrismFields fields = prism_box({{0, 0, 0}, 0.5, 0.5, 41, 41}, 0, 10);
    fields.apply(Tool::capsule({10, 10, -5}, {10, 10, 15}, radius), Edit::remove);
    const field::FunctionPtr f = as_function(fields, {.reach = 3, .rounding = rounding});
    const double step = 6.283185307 / n;
    for (int k = 0; k < n; ++k) {
      const double a = wall_at(*f, k * step), b = wall_at(*f, (k + 1) * step);
      EXPECT_NEAR(a, radius, 0.5);
      sum += (b - a) * (b - a) / (a * a * step * step);
    }
  }
  return std::sqrt(sum / (3 * n));
}

TEST(PrismFunction, RoundingTakesTheStairsOffShafts) {
  const double stairs = unevenness(0), round = unevenness(0.7);
  EXPECT_GT(stairs, 0.3);
  EXPECT_LT(round, 0.6 * stairs);
  // Planes stay where they are.
  const field::FunctionPtr f =
      as_function(prism_box({{0, 0, 0}, 1, 1, 21, 21}, 0, 8), {.reach = 3, .rounding = 0.7});
  for (const Vec3d p : {Vec3d{10, 10, 8.25}, {10, 10, -0.25}, {-0.25, 10, 4}, {10, 20.25, 4}}) {
    float v;
    f->values({&p, 1}, {&v, 1});
    EXPECT_NEAR(v, -0.25, 1e-6);
  }
}

// From one side of a wall or a slab to the other nothing jumps: the value is small beside every change of
// sign.
TEST(PrismFunction, ChangesSignAtSmallValues) {
  Random random(33);
  for (int round = 0; round < 10; ++round) {
    const field::FunctionPtr f = as_function(dug(random, 3 * round), {.reach = 3});
    for (int n = 0; n < 2000; ++n) {
      Vec3d a = random_point(random, {{3, -4, 8}, {18, 14, 16}}),
            b = a + random_point(random, {{-1, -1, -1}, {1, 1, 1}});
      float va, vb;
      f->values({&a, 1}, {&va, 1});
      f->values({&b, 1}, {&vb, 1});
      if ((va > 0) == (vb > 0)) continue;
      for (int k = 0; k < 40; ++k) {
        const Vec3d m = (a + b) * 0.5;
        float v;
        f->values({&m, 1}, {&v, 1});
        if ((v > 0) == (va > 0)) {
          a = m, va = v;
        } else {
          b = m, vb = v;
        }
      }
      EXPECT_LT(std::abs(va), 2e-3) << round << " at " << a.x << ", " << a.y << ", " << a.z;
      EXPECT_LT(std::abs(vb), 2e-3) << round;
    }
  }
}

}  // namespace
}  // namespace tafoni::volume
