// A grid as a leaf: its range encloses its values, batches agree, pruned evaluation equals brute force.

#include <bit>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/test/lattice.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {
namespace {

/// Rolling ground with a hollow, and noise of one cell's wavelength; flat far above and below.
ScalarGrid hollow(const GridFrame& frame, Precision precision = Precision::single) {
  ScalarGrid grid(frame, -7.5f, precision);
  const Vec3d middle = frame.box().center();
  Random random(5);
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (int i = 0; i < std::ssize(row); ++i) {
      const Vec3d p = frame.position(first + Vec3i{i, 0, 0});
      const double ground = 6 * std::sin(p.x * 0.11) * std::cos(p.y * 0.07) - (p.z - middle.z);
      const double cave = length(p - middle + Vec3d{0, 0, 9}) - 8;
      const double bump = std::abs(ground) < 7 ? random.uniform(-0.4, 0.4) : 0;
      row[i] = static_cast<float>(std::clamp(std::min(ground, cave) + bump, -7.5, 7.5));
    }
  });
  grid.compact();
  return grid;
}

GridFrame frame_at(Vec3d origin, double spacing) {
  return {origin, spacing, {75, 70, 65}};
}

std::uint32_t bits(float v) {
  return std::bit_cast<std::uint32_t>(v);
}

TEST(GridFunction, RangeEnclosesValuesEverywhere) {
  const ScalarGrid grid = hollow(frame_at({-30.2, -28.7, -33.3}, 0.9));
  const field::FunctionPtr f = as_function(grid);
  const Box3d around = grid.frame().box().grown(20);
  Random random(1);
  double slack = 0;
  int small = 0;
  for (int n = 0; n < 3000; ++n) {
    Vec3d c, half;
    for (double Vec3d::*axis : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
      c.*axis = random.uniform(around.lo.*axis, around.hi.*axis);
      half.*axis = std::pow(10, random.uniform(-2, 1.5));
    }
    const Box3d box{c - half, c + half};
    std::vector<Vec3d> points;
    for (int i = 0; i < 40; ++i)
      points.push_back({random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                        random.uniform(box.lo.z, box.hi.z)});
    for (int i = 0; i < 8; ++i)
      points.push_back(
          {i & 1 ? box.lo.x : box.hi.x, i & 2 ? box.lo.y : box.hi.y, i & 4 ? box.lo.z : box.hi.z});
    std::vector<float> values(points.size());
    f->values(points, values);
    const Interval range = f->range(box);
    Interval seen{values[0], values[0]};
    for (const float v : values) {
      ASSERT_TRUE(range.contains(v)) << v << " in " << range.lo << " to " << range.hi;
      seen = {std::min(seen.lo, v), std::max(seen.hi, v)};
    }
    if (half.x > 0.5 || half.y > 0.5 || half.z > 0.5) continue;
    ++small;
    slack += (range.hi - range.lo) - (seen.hi - seen.lo);
  }
  // A box of less than a cell reads 8 to 27 samples; its range must be of their magnitude, not of the grid's.
  ASSERT_GT(small, 50);
  EXPECT_LT(slack / small, 1.5);
}

TEST(GridFunction, BatchesAgreeBitForBitAndContinueBeyondTheFrame) {
  const ScalarGrid grid = hollow(frame_at({12, -50, 3}, 1.5));
  const field::CompiledField field = field::compile(field::function(as_function(grid)));
  const Box3d box = grid.frame().box(), around = box.grown(30);
  Random random(2);
  std::vector<Vec3d> points;
  for (int i = 0; i < 5000; ++i)
    points.push_back({random.uniform(around.lo.x, around.hi.x), random.uniform(around.lo.y, around.hi.y),
                      random.uniform(around.lo.z, around.hi.z)});
  std::vector<float> values(points.size());
  field.values(points, values);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(bits(values[i]), bits(field.value(points[i])));
    ASSERT_EQ(bits(values[i]), bits(grid.value(points[i])));
    const Vec3d p = points[i];
    const Vec3d inside{std::clamp(p.x, box.lo.x, box.hi.x), std::clamp(p.y, box.lo.y, box.hi.y),
                       std::clamp(p.z, box.lo.z, box.hi.z)};
    ASSERT_NEAR(values[i], grid.value(inside), 1e-5);
  }
}

TEST(GridFunction, GradientsAreThoseOfTheTrilinearFunction) {
  const ScalarGrid grid = hollow(frame_at({-40, -40, -30}, 1.25));
  const field::CompiledField field = field::compile(field::function(as_function(grid)));
  Random random(3);
  const double h = 0.01;
  for (int n = 0; n < 2000; ++n) {
    // Well inside a cell, where the function is smooth.
    const Vec3d p =
        grid.frame().origin + Vec3d{std::floor(random.uniform(0, 74)) + random.uniform(0.1, 0.9),
                                    std::floor(random.uniform(0, 69)) + random.uniform(0.1, 0.9),
                                    std::floor(random.uniform(0, 64)) + random.uniform(0.1, 0.9)} *
                                  grid.frame().spacing;
    float value = 0;
    Vec3f g;
    field.gradients({&p, 1}, {&value, 1}, {&g, 1});
    EXPECT_EQ(bits(value), bits(field.value(p)));
    const auto slope = [&](Vec3d d) { return (grid.value(p + d * h) - grid.value(p - d * h)) / (2 * h); };
    EXPECT_NEAR(g.x, slope({1, 0, 0}), 2e-4);
    EXPECT_NEAR(g.y, slope({0, 1, 0}), 2e-4);
    EXPECT_NEAR(g.z, slope({0, 0, 1}), 2e-4);
  }
}

TEST(GridFunction, PrunedEqualsBruteForceOnTheLatticeAndOffIt) {
  struct Case {
    Vec3d origin;
    double spacing, voxel;
    Precision precision;
  };
  for (const Case& c :
       {Case{{-32, -30, -40}, 1, 1, Precision::single}, Case{{-31.37, -30.11, -39.73}, 1, 1, Precision::half},
        Case{{-60.3, -55.9, -48.1}, 1.7, 0.9, Precision::single}}) {
    const field::CompiledField field =
        field::compile(field::function(as_function(hollow(frame_at(c.origin, c.spacing), c.precision))));
    EXPECT_GT(field::Lattice(field, c.voxel).check(-1, 0, -1, 0), 10000u);
  }
}

TEST(GridFunction, PrunesExactlyInsideATree) {
  const field::NodePtr grid = field::function(as_function(hollow(frame_at({-20.3, -25.1, -44}, 0.8))));
  field::CloudBuilder cloud({"point", 15, {}});
  Random random(4);
  for (int i = 0; i < 60; ++i)
    field::add_point(cloud, {random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-20, 5)},
                     random.uniform(3, 9), random.uniform(-9, 6));
  const field::NodePtr points = cloud.finish();
  for (const char* op : {"union", "intersection", "difference"}) {
    const field::CompiledField field = field::compile(
        field::blend({field::combine(op, {field::terrain(15, 7.5, true, true, false), grid}), points}));
    EXPECT_GT(field::Lattice(field, 1).check(-1, 0, -1, 0), 10000u) << op;
  }
}

TEST(GridFunction, IsASnapshot) {
  ScalarGrid grid = hollow(frame_at({-40, -40, -30}, 1));
  const field::CompiledField field = field::compile(field::function(as_function(grid)));
  const Vec3d p = grid.frame().position({30, 30, 30});
  const float before = field.value(p);
  grid.edit(grid.samples(), [](Vec3i, std::span<float> row) {
    for (float& v : row) v = 3;
  });
  EXPECT_EQ(bits(field.value(p)), bits(before));
  EXPECT_EQ(grid.value(p), 3);
}

}  // namespace
}  // namespace tafoni::volume
