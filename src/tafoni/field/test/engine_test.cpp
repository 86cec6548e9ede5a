// Pruned, packed and brute-force evaluation agree bit for bit; the field agrees with its definition in
// double.

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/test/lattice.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/whole.h"

namespace tafoni::field {
namespace {

using testing::HasSubstr;

NodePtr scene(const NodePtr& terrain, int points, double extent, std::uint64_t seed, double noise = 0,
              double radius_hi = 6) {
  CloudBuilder cloud({"point", 15, {noise, 3, 2, 1}});
  Random random(seed);
  for (int i = 0; i < points; ++i)
    add_point(cloud,
              {random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-20, 20)},
              random.uniform(2.5, radius_hi), random.uniform(-9, 4));
  return blend({terrain, cloud.finish()});
}

TEST(Engine, ChunksEqualPointsBitForBit) {
  for (int seed = 0; seed < 4; ++seed) {
    const CompiledField field = compile(scene(terrain(), 400, 90, seed));
    Lattice lattice(field, seed % 2 ? 1.0 : 0.7310585);
    EXPECT_GT(lattice.check(-1, 0, -1, 0), 10000u);
  }
}

TEST(Engine, ChunksEqualPointsForEverySetting) {
  for (bool bicubic : {false, true})
    for (bool first_order : {false, true})
      for (bool prism : {false, true}) {
        const CompiledField field = compile(scene(terrain(9, 4, bicubic, first_order, prism), 100, 60, 7));
        EXPECT_GT(Lattice(field, 1.3).check(0, 0, -1, -1), 1000u);
      }
}

TEST(Engine, NoisyMetricPrunesExactly) {
  const CompiledField field = compile(scene(terrain(), 300, 60, 5, 1.5));
  EXPECT_GT(Lattice(field, 0.9).check(-1, 0, 0, 0), 10000u);
}

TEST(Engine, EveryKindAndOperatorPrunesExactly) {
  Random random(11);
  const auto somewhere = [&] {
    return Vec3d{random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-15, 15)};
  };
  CloudBuilder spheres({"sphere", 6, {}}), segments({"segment", 15, {0.5, 2, 2, 1}}),
      curves({"curve", 15, {}});
  for (int i = 0; i < 60; ++i) {
    const float r = draw_float(random, 1, 4);
    const float e = draw_float(random, -9, 9);
    const auto step = [&] { return draw_float(random, -12, 12); };
    spheres.add(somewhere(), e, std::vector<float>{r});
    segments.add(somewhere(), e, std::vector<float>{r + 1, step(), step(), step()});
    curves.add(somewhere(), e, std::vector<float>{r + 1, step(), step(), step(), step(), step(), step()});
  }
  const NodePtr ball = blend({constant(-7.5f), spheres.finish()});
  const NodePtr root = subtract(unite({blend({terrain(), segments.finish()}), ball}),
                                blend({constant(-7.5f), curves.finish()}));
  EXPECT_GT(Lattice(compile(root), 0.8).check(-1, 0, -1, 0), 10000u);
}

TEST(Engine, PrimitivesMayStraddleAnyBorderAndVaryInSize) {
  CloudBuilder cloud({"point", 15, {}});
  for (int i = -2; i <= 2; ++i)
    for (double r : {0.4, 3.0, 30.0}) add_point(cloud, {i * 64.0, 64.0, i * 0.001}, r, -8 - i);
  add_point(cloud, {0, 0, 0}, 200, 1);
  const CompiledField field = compile(blend({terrain(), cloud.finish()}));
  EXPECT_GT(Lattice(field, 1.0).check(-2, 1, 0, 1), 10000u);
}

TEST(Engine, AMillionPrimitivesAtOneSpot) {
  CloudBuilder cloud({"point", 15, {}});
  for (int i = 0; i < 1000000; ++i) add_point(cloud, {3, 4, 0}, 1.5, i % 2 ? -1.01 : 1.0);
  const CompiledField field = compile(blend({terrain(), cloud.finish()}));
  // Far from the spot nothing is spent on it.
  EXPECT_EQ(field.value({80, 80, 0}), compile(terrain()).value({80, 80, 0}));
  // A float sum of n terms may lose n 2^-24 of the sum of their magnitudes; in practice far less.
  const double sum = -0.01 * 500000;
  EXPECT_NEAR(field.value({3, 4, 0}), sum + compile(terrain()).value({3, 4, 0}), 0.005 * 1.005e6);
  EXPECT_GT(Lattice(field, 1.0).check(0, 0, 0, 0), 1000u);
}

TEST(Engine, NoPrimitivesAtAll) {
  CloudBuilder cloud({"point", 15, {}});
  const CompiledField field = compile(blend({terrain(), cloud.finish()}));
  const CompiledField bare = compile(terrain());
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vec3d p{random.uniform(-120, 120), random.uniform(-120, 120), random.uniform(-80, 40)};
    EXPECT_EQ(field.value(p), bare.value(p));
  }
  EXPECT_GT(Lattice(field, 1.0).check(0, 0, 0, 0), 1000u);
}

TEST(Engine, OrderOfAddingAndThreadsDoNotMatter) {
  std::vector<Vec3d> centers;
  Random random(4);
  for (int i = 0; i < 5000; ++i)
    centers.push_back({random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-10, 10)});
  const auto build = [&](bool reversed) {
    CloudBuilder cloud({"point", 15, {}});
    for (std::size_t i = 0; i < centers.size(); ++i)
      add_point(cloud, centers[reversed ? centers.size() - 1 - i : i], 5, -3);
    return compile(blend({terrain(), cloud.finish()}));
  };
  const CompiledField one = build(false), other = build(true);
  std::vector<float> a(centers.size()), b(centers.size());
  set_thread_count(1);
  one.values(centers, a);
  set_thread_count(2);
  other.values(centers, b);
  set_thread_count(0);
  EXPECT_EQ(a, b);
}

/// The definition [Paris19 §5.1, §5.2] in double: f = min(f_T, f_P) + sum of energy g, vertical distance,
/// bilinear heights.
TEST(Engine, AgreesWithTheDefinitionInDouble) {
  const double R = 15, T = 7.5;
  const auto heights = hills(40, 5, 12, 3);
  struct P {
    Vec3d c;
    double r, e;
  };
  std::vector<P> prims;
  CloudBuilder cloud({"point", R, {}}), balls({"sphere", R, {}});
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    prims.push_back({{random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-15, 15)},
                     random.uniform(2, 8),
                     random.uniform(-8, 8)});
    if (i < 400)
      add_point(cloud, prims.back().c, prims.back().r, prims.back().e);
    else
      balls.add(prims.back().c, static_cast<float>(prims.back().e),
                std::vector<float>{static_cast<float>(prims.back().r)});
  }
  const HeightfieldSettings settings{R, T, false, false};
  const CompiledField field =
      compile(blend({intersect({heightfield(heights, settings),
                                domain({{{-100, -100, -60}, {100, 100, 0}}, nullptr}, settings)}),
                     cloud.finish(), balls.finish()}));
  const auto sigma = [&](double x) {
    const double a = std::fabs(x);
    const double s =
        a < R ? a + (3 * T - 2 * R) / (R * R) * a * a + (R - 2 * T) / (R * R * R) * a * a * a : T;
    return std::copysign(s, x);
  };
  const auto g = [](double u) { return u < 1 ? std::pow(1 - u * u, 3) : 0.0; };
  for (int i = 0; i < 3000; ++i) {
    const Vec3d p{random.uniform(-110, 110), random.uniform(-110, 110), random.uniform(-70, 30)};
    const Vec2d q = heights->placement.pixel(p.x, p.y);
    const double u = std::clamp(q.x, 0.0, 39.0), v = std::clamp(q.y, 0.0, 39.0);
    const int x = std::min(floor_to(u), 38), y = std::min(floor_to(v), 38);
    const double fx = u - x, fy = v - y;
    const auto& h = heights->values;
    const double height = (h.at(x, y) * (1 - fx) + h.at(x + 1, y) * fx) * (1 - fy) +
                          (h.at(x, y + 1) * (1 - fx) + h.at(x + 1, y + 1) * fx) * fy;
    const double west = std::min(p.x + 100, 100 - p.x), south = std::min(p.y + 100, 100 - p.y),
                 base = p.z + 60;
    const double outside = std::hypot(std::min(west, 0.0), std::min(south, 0.0), std::min(base, 0.0));
    const double inside = outside > 0 ? -outside : std::min({west, south, base});
    double f = std::min(sigma(height - p.z), sigma(inside));
    for (std::size_t k = 0; k < prims.size(); ++k) {
      const double d = length(p - prims[k].c);
      f += prims[k].e * (k < 400 ? g(d / prims[k].r) : g(std::max(d - prims[k].r, 0.0) / R));
    }
    EXPECT_NEAR(field.value(p), f, 1e-4 * T);
  }
}

TEST(Engine, GradientsMatchDifferences) {
  for (int variant = 0; variant < 3; ++variant) {
    const CompiledField field =
        compile(scene(terrain(15, 7.5, true, variant != 1), 300, 60, 3, variant == 2 ? 1.0 : 0.0));
    Random random(5);
    std::vector<Vec3d> points;
    for (int i = 0; i < 400; ++i)
      points.push_back({random.uniform(-70, 70), random.uniform(-70, 70), random.uniform(-15, 15)});
    std::vector<float> values(points.size());
    std::vector<Vec3f> gradients(points.size());
    field.gradients(points, values, gradients);
    int rough = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(values[i], field.value(points[i]));
      const double h = 0.02;
      const Vec3d p = points[i];
      const Vec3d d{(field.value(p + Vec3d{h, 0, 0}) - field.value(p - Vec3d{h, 0, 0})) / (2 * h),
                    (field.value(p + Vec3d{0, h, 0}) - field.value(p - Vec3d{0, h, 0})) / (2 * h),
                    (field.value(p + Vec3d{0, 0, h}) - field.value(p - Vec3d{0, 0, h})) / (2 * h)};
      rough += length(d - to_double(gradients[i])) > 0.02 * (1 + length(d));
    }
    EXPECT_LE(rough, 8) << "variant " << variant << ": more than kinks can explain";
  }
}

TEST(Engine, ChunkGradientsEqualFieldGradients) {
  const CompiledField field = compile(scene(terrain(), 400, 60, 8, 0.5));
  ChunkEvaluator evaluator(field, 1.0);
  ChunkSamples chunk;
  evaluator.column(0, 0);
  ASSERT_TRUE(evaluator.evaluate(-1, chunk) || evaluator.evaluate(0, chunk));
  Random random(2);
  std::vector<Vec3d> points;
  for (int i = 0; i < 1000; ++i)
    points.push_back(
        {random.uniform(0, 64), random.uniform(0, 64), chunk.chunk.z * 64 + random.uniform(0, 64)});
  points.push_back({64, 64, chunk.chunk.z * 64 + 64.0});
  std::vector<float> v1(points.size()), v2(points.size());
  std::vector<Vec3f> g1(points.size()), g2(points.size());
  evaluator.gradients(points, v1, g1);
  field.gradients(points, v2, g2);
  EXPECT_EQ(v1, v2);
  EXPECT_EQ(g1, g2);
}

TEST(Engine, IntervalsEncloseValues) {
  const CompiledField field = compile(scene(terrain(), 400, 80, 12, 0.8));
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    const Vec3d c{random.uniform(-110, 110), random.uniform(-110, 110), random.uniform(-70, 30)};
    const double r = random.uniform(0.1, 20);
    const Box3d box = Box3d{c, c}.grown(r);
    const Interval range = field.interval(box);
    for (int k = 0; k < 50; ++k) {
      const Vec3d p{random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                    random.uniform(box.lo.z, box.hi.z)};
      const float v = field.value(p);
      EXPECT_GE(v, range.lo);
      EXPECT_LE(v, range.hi);
    }
  }
}

TEST(Engine, DeepTreesNeitherOverflowNorLeak) {
  NodePtr node = terrain();
  for (int i = 0; i < 200000; ++i) node = unite({node, constant(-1000.f)});
  EXPECT_EQ(compile(node).value({1, 2, 0}), compile(terrain()).value({1, 2, 0}));
}

TEST(Tree, CurvesFollowCatmullRom) {
  const std::vector<Vec3d> points{{0, 0, 0}, {10, 4, 0}, {14, 15, 3}, {30, 12, -5}};
  CloudBuilder cloud({"curve", 15, {}});
  add_curve(cloud, points, 6, -8, 0.01);
  const CompiledField field = compile(cloud.finish());
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec3d p0 = points[i > 0 ? i - 1 : 0], p1 = points[i], p2 = points[i + 1],
                p3 = points[std::min(i + 2, points.size() - 1)];
    for (double t = 0; t <= 1; t += 0.05) {
      const double t2 = t * t, t3 = t2 * t;
      const Vec3d on = (p0 * (-t3 + 2 * t2 - t) + p1 * (3 * t3 - 5 * t2 + 2) + p2 * (-3 * t3 + 4 * t2 + t) +
                        p3 * (t3 - t2)) *
                       0.5;
      EXPECT_NEAR(field.value(on), -8, 1e-3) << i << " " << t;
    }
  }
}

TEST(Tree, RefusesWhatCannotBeAField) {
  EXPECT_THAT(error_of([&] {
                heightfield(hills(4, 1, 1, 1), {20, 6, true, true});
              }),
              HasSubstr("is over three times amplitude"));
  CloudBuilder cloud({"point", 15, {}});
  EXPECT_THAT(error_of([&] {
                add_point(cloud, {0, 0, 0}, -1, 1);
              }),
              HasSubstr("has radius -1 m; it must be positive"));
  EXPECT_THAT(error_of([&] {
                add_point(cloud, {0, 0, NAN}, 1, 1);
              }),
              HasSubstr("has a number that is not finite"));
  EXPECT_THAT(error_of([&] {
                add_point(cloud, {1e6, 0, 0}, 1, 1);
              }),
              HasSubstr("lies 1000000 m from the scene's origin"));
  const std::vector<float> two{1, 2};
  EXPECT_EQ(error_of([&] { cloud.add({0, 0, 0}, 1, two); }), "a point primitive cannot have 2 shape numbers");
  EXPECT_THAT(error_of([&] { CloudBuilder({"pont", 15, {}}); }), HasSubstr("there is no primitive \"pont\""));
  EXPECT_THAT(error_of([&] { combine("unio", {constant(1)}); }), HasSubstr("there is no operator \"unio\""));
}

}  // namespace
}  // namespace tafoni::field
