// A sampled field holds the field's own bits; what is constant costs nothing; trilinear error is of order
// two.

#include "tafoni/volume/sample.h"

#include <bit>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/each_point.h"
#include "tafoni/field/test/lattice.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/lattice.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

std::uint32_t bits_of(float v) {
  return std::bit_cast<std::uint32_t>(v);
}

field::NodePtr carved(int points = 300) {
  field::CloudBuilder cloud({"point", 15, {}});
  Random random(9);
  for (int i = 0; i < points; ++i)
    field::add_point(cloud, {random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(-25, 10)},
                     random.uniform(2, 8), random.uniform(-9, 4));
  return field::blend({field::terrain(), cloud.finish()});
}

class Shape : public field::Function {
 public:
  virtual double at(Vec3d p) const = 0;
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field::each_point(points, out, [this](Vec3d p) { return at(p); });
  }
  /// All of these change by at most one a metre.
  Interval range(const Box3d& box) const override {
    const double reach = length(box.size()) / 2, middle = at(box.center());
    return rounded(middle - reach - 1e-3, middle + reach + 1e-3);
  }
};
struct Sphere final : Shape {
  double at(Vec3d p) const override { return 20 - length(p - Vec3d{0.3, -0.2, 0.1}); }
};
struct Torus final : Shape {
  double at(Vec3d p) const override { return 6 - std::hypot(std::hypot(p.x, p.y) - 16, p.z); }
};

TEST(Sample, HoldsTheFieldsBits) {
  // With leaves of every kind: heights, domain, primitives, a function, a warp.
  const field::NodePtr ball = field::function(std::make_shared<Sphere>());
  const field::CompiledField field =
      field::compile(field::unite({field::warp(carved(), nullptr, {{1.5, 1.5, 1}, 15, 15, 2, 1}), ball}));
  for (const GridFrame& frame :
       {GridFrame{{-70, -66, -40}, 1, {97, 80, 70}}, GridFrame{{-20.13, 7.77, -31.9}, 0.37, {65, 33, 100}}}) {
    const ScalarGrid grid = sample(field, frame);
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
      const auto index = [&](int n) { return draw_index(random, n); };
      const Vec3i s{index(frame.size.x), index(frame.size.y), index(frame.size.z)};
      ASSERT_EQ(bits_of(grid.at(s)), bits_of(field.value(frame.position(s))))
          << s.x << " " << s.y << " " << s.z;
    }
  }
}

TEST(Sample, LimitsToABandAndRoundsToHalf) {
  const field::CompiledField field = field::compile(carved());
  const GridFrame frame{{-70, -66, -40}, 1, {97, 80, 70}};
  const ScalarGrid whole = sample(field, frame), band = sample(field, frame, {Precision::single, 2.5}),
                   half = sample(field, frame, {Precision::half, 2.5});
  float greatest = 0;
  for (int z = 0; z < frame.size.z; ++z)
    for (int y = 0; y < frame.size.y; y += 3)
      for (int x = 0; x < frame.size.x; ++x) {
        const float v = std::clamp(whole.at({x, y, z}), -2.5f, 2.5f);
        ASSERT_EQ(bits_of(band.at({x, y, z})), bits_of(v));
        // Half precision has 11 bits: half an ulp is 2^-12 of the power of two below.
        const float ulp = std::ldexp(1.0f, std::max(std::ilogb(v == 0 ? 1e-9f : v), -14) - 10);
        ASSERT_LE(std::abs(half.at({x, y, z}) - v), ulp / 2);
        greatest = std::max(greatest, std::abs(v));
      }
  EXPECT_EQ(greatest, 2.5f);
  EXPECT_LT(band.full_chunks(), whole.full_chunks());
  EXPECT_LT(half.bytes(), band.bytes() * 6 / 10);
}

TEST(Sample, ConstantChunksCostNothing) {
  const field::CompiledField field = field::compile(field::terrain(15, 7.5, true, true, false));
  const GridFrame frame{{-64, -64, -300}, 1, {128, 128, 600}};
  const ScalarGrid grid = sample(field, frame);
  // The field varies within R = 15 m of a surface that stays within 15 m of 0.
  const Vec3i n = grid.chunks();
  const int layers = 4;
  EXPECT_LE(grid.full_chunks(), n.x * n.y * layers);
  EXPECT_GT(grid.full_chunks(), 0u);
  float below = 0, above = 0;
  EXPECT_TRUE(grid.uniform({0, 0, 0}, &below));
  EXPECT_TRUE(grid.uniform({0, 0, n.z - 1}, &above));
  EXPECT_EQ(below, 7.5f);
  EXPECT_EQ(above, -7.5f);
}

TEST(Sample, DoesNotDependOnThreadsAndCanBeCancelled) {
  const field::CompiledField field = field::compile(carved());
  const GridFrame frame{{-70, -66, -40}, 1.1, {97, 80, 70}};
  set_thread_count(1);
  const ScalarGrid one = sample(field, frame, {Precision::single, 3});
  set_thread_count(3);
  const ScalarGrid three = sample(field, frame, {Precision::single, 3});
  set_thread_count(0);
  EXPECT_TRUE(one == three);
  Progress progress;
  progress.cancel();
  EXPECT_EQ(error_of([&] { sample(field, frame, {}, progress); }), "cancelled");
}

/// The greatest difference of grid and field at random points within `reach` of the surface.
double error_near_surface(const Shape& shape, const ScalarGrid& grid, double reach) {
  Random random(8);
  double worst = 0;
  const Box3d box = grid.frame().box();
  for (int i = 0; i < 60000; ++i) {
    const Vec3d p{random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                  random.uniform(box.lo.z, box.hi.z)};
    const double truth = shape.at(p);
    if (std::abs(truth) < reach) worst = std::max(worst, std::abs(grid.value(p) - truth));
  }
  return worst;
}

// Interpolating linearly along an axis errs by at most h^2 / 8 max |f''|; trilinearly, by the sum over the
// axes. The second derivatives of a distance sum to its level's curvatures.
TEST(Sample, TrilinearErrorIsThatOfTheCellSize) {
  struct Case {
    std::shared_ptr<const Shape> shape;
    double (*curvature)(double inside);  // greatest |k1| + |k2| up to that far inside of the surface
  };
  const Case cases[] = {{std::make_shared<Sphere>(), [](double d) { return 2 / (20 - d); }},
                        {std::make_shared<Torus>(), [](double d) { return 1 / (6 - d) + 1 / (16 - 6 - d); }}};
  const double reach = 2;
  for (const Case& c : cases) {
    const field::CompiledField field = field::compile(field::function(c.shape));
    double before = 0;
    for (const double h : {1.0, 0.5, 0.25}) {
      const ScalarGrid grid =
          sample(field, frame_over({{-24, -24, -24}, {24, 24, 24}}, h), {Precision::single, 4});
      const double predicted = h * h / 8 * c.curvature(reach + std::sqrt(3.0) * h);
      const double error = error_near_surface(*c.shape, grid, reach);
      EXPECT_LE(error, predicted + 1e-5) << h;
      EXPECT_GE(error, predicted / 4) << h;
      if (before > 0) {
        EXPECT_NEAR(before / error, 4, 0.8) << "order two at " << h;
      }
      before = error;
    }
  }
}

TEST(Sample, FramesCoverTheirBoxOnTheLattice) {
  const GridFrame frame = frame_over({{-3.2, 0.1, 7}, {4.9, 0.2, 9.01}}, 0.5);
  EXPECT_EQ(frame.origin, (Vec3d{-3.5, 0, 7}));
  EXPECT_EQ(frame.size, (Vec3i{18, 2, 6}));
  EXPECT_THAT(error_of([&] { frame_over({}, 1); }), HasSubstr("must be a bounded box"));
  EXPECT_THAT(error_of([&] { frame_over(Box3d::everything(), 1); }), HasSubstr("must be a bounded box"));
  EXPECT_THAT(error_of([&] {
                frame_over({{0, 0, 0}, {1, 1, 1}}, 0);
              }),
              HasSubstr("spacing must be a positive length in metres, not 0"));
  EXPECT_THAT(error_of([&] {
                frame_over({{0, 0, 0}, {1, 1, 1}}, 1e-12);
              }),
              HasSubstr("1e-12 m is too fine a spacing"));
  EXPECT_THAT(error_of([&] {
                sample(field::compile(field::constant(1)), frame, {Precision::single, -1});
              }),
              HasSubstr("band must be a length in metres, 0 for none, not -1"));
}

}  // namespace
}  // namespace tafoni::volume
