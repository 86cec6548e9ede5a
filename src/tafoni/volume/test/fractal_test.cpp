#include "tafoni/volume/fractal.h"

#include <array>
#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/math/draw.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

/// [Ju01]'s cube: air on top, rock below.
FractalSettings plane(Vec3i cells, int levels) {
  FractalSettings s;
  s.cells = cells;
  s.levels = levels;
  for (int z = 0; z <= cells.z; ++z)
    for (int i = 0; i < (cells.x + 1) * (cells.y + 1); ++i)
      s.coarse.push_back(static_cast<float>(cells.z - 2 * z));
  return s;
}

FractalSettings rough(Vec3i cells, int levels, double scale = 0.7) {
  FractalSettings s = plane(cells, levels);
  s.noise = decaying_noise(scale, 0.5, levels, 0);
  s.seed = 7;
  return s;
}

std::vector<float> all(const Fractal& f) {
  const Vec3i n = f.settings().size();
  std::vector<float> out(std::int64_t{n.x} * n.y * n.z);
  f.read({{0, 0, 0}, {n.x - 1, n.y - 1, n.z - 1}}, out.data());
  return out;
}

std::size_t place(Vec3i n, int x, int y, int z) {
  return (std::int64_t{z} * n.y + y) * n.x + x;
}

TEST(Fractal, IsTheFlatPlaneWithoutNoise) {
  const FractalSettings s = plane({2, 2, 1}, 6);
  const Fractal f(s);
  const Vec3i n = s.size();
  EXPECT_EQ(n, (Vec3i{129, 129, 65}));
  const auto v = all(f);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x)
        ASSERT_EQ(v[place(n, x, y, z)], 1 - z / 32.0) << x << ' ' << y << ' ' << z;
}

TEST(Fractal, KeepsAnyTiltedPlaneExactly) {
  FractalSettings s = plane({2, 3, 2}, 4);
  std::size_t i = 0;
  for (int z = 0; z <= 2; ++z)
    for (int y = 0; y <= 3; ++y)
      for (int x = 0; x <= 2; ++x) s.coarse[i++] = static_cast<float>(16 * x - 32 * y + 48 * z - 5);
  const auto v = all(Fractal(s));
  const Vec3i n = s.size();
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) ASSERT_EQ(v[place(n, x, y, z)], x - 2 * y + 3 * z - 5);
}

/// The rule as it is stated, one axis after another, without boxes, kernels or threads.
std::vector<double> by_the_rule(const std::vector<double>& coarse, Vec3i n) {
  std::vector<double> from = coarse;
  for (int axis = 2; axis >= 0; --axis) {
    const std::array<int, 3> was{n.x, n.y, n.z};
    Vec3i fine = n;
    (axis == 0 ? fine.x : axis == 1 ? fine.y : fine.z) = 2 * was[axis] - 1;
    std::vector<double> to(fine.x * fine.y * fine.z);
    for (int z = 0; z < fine.z; ++z)
      for (int y = 0; y < fine.y; ++y)
        for (int x = 0; x < fine.x; ++x) {
          const std::array<int, 3> at{x, y, z};
          const int c = at[axis], count = was[axis];
          const auto sample = [&](int i) {
            const auto own = [&](int j) {
              std::array<int, 3> p = at;
              p[axis] = j;
              return from[place(n, p[0], p[1], p[2])];
            };
            if (i < 0) return 2 * own(0) - own(1);
            if (i >= count) return 2 * own(count - 1) - own(count - 2);
            return own(i);
          };
          const int i = c / 2;
          to[place(fine, x, y, z)] =
              c % 2 == 0 ? sample(i) : (9 * (sample(i) + sample(i + 1)) - sample(i - 1) - sample(i + 2)) / 16;
        }
    from = to;
    n = fine;
  }
  return from;
}

TEST(Fractal, FollowsTheFourPointRule) {
  FractalSettings s;
  s.cells = {5, 2, 3};
  s.levels = 1;
  Random random(3);
  std::vector<double> coarse;
  for (int i = 0; i < 6 * 3 * 4; ++i) {
    s.coarse.push_back(draw_float(random, -1, 1));
    coarse.push_back(s.coarse.back());
  }
  const auto v = all(Fractal(s));
  const auto truth = by_the_rule(coarse, {6, 3, 4});
  ASSERT_EQ(v.size(), truth.size());
  for (std::size_t i = 0; i < v.size(); ++i) ASSERT_NEAR(v[i], truth[i], 1e-6);
}

TEST(Fractal, EveryLevelKeepsTheSamplesOfTheOneBefore) {
  const FractalSettings s = rough({3, 2, 2}, 5);
  FractalSettings fewer = s;
  fewer.levels = 4;
  const auto fine = all(Fractal(s)), coarse = all(Fractal(fewer));
  const Vec3i n = s.size(), m = fewer.size();
  for (int z = 0; z < m.z; ++z)
    for (int y = 0; y < m.y; ++y)
      for (int x = 0; x < m.x; ++x) ASSERT_EQ(fine[place(n, 2 * x, 2 * y, 2 * z)], coarse[place(m, x, y, z)]);
}

TEST(Fractal, AnyPartOnAnyThreadsHasTheSameBits) {
  const FractalSettings s = rough({3, 2, 1}, 5);
  const auto whole = all(Fractal(s));
  set_thread_count(1);
  const Fractal one(s);
  const ScalarGrid grid_of_one = one.grid();
  set_thread_count(3);
  const Fractal f(s);
  EXPECT_TRUE(f.grid() == grid_of_one);
  set_thread_count(0);
  EXPECT_EQ(all(one), whole);
  const Vec3i n = s.size();
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    SampleBox box;
    const auto side = [&](int size, int& lo, int& hi) {
      lo = draw_index(random, size);
      hi = lo + draw_index(random, size - lo);
    };
    side(n.x, box.lo.x, box.hi.x);
    side(n.y, box.lo.y, box.hi.y);
    side(n.z, box.lo.z, box.hi.z);
    const Vec3i b = box.size();
    std::vector<float> part(b.x * b.y * b.z);
    f.read(box, part.data());
    const Interval range = f.range(box);
    for (int z = 0; z < b.z; ++z)
      for (int y = 0; y < b.y; ++y)
        for (int x = 0; x < b.x; ++x) {
          const float v = part[place(b, x, y, z)];
          ASSERT_EQ(v, whole[place(n, box.lo.x + x, box.lo.y + y, box.lo.z + z)]);
          ASSERT_TRUE(range.contains(v));
        }
  }
  const SampleBox middle{{30, 5, 7}, {80, 60, 30}};
  const ScalarGrid part = f.grid(middle);
  EXPECT_EQ(part.frame().origin, (Vec3d{30, 5, 7}));
  EXPECT_EQ(part.at({3, 40, 20}), grid_of_one.at({33, 45, 27}));
  EXPECT_EQ(grid_of_one.at({33, 45, 27}), whole[place(n, 33, 45, 27)]);
}

/// Mean and variance of what a level adds: the difference between the samples that are new in it and the
/// smooth ones.
struct Added {
  double mean, variance, most;
};
Added added(const FractalSettings& s, int level) {
  FractalSettings with = s, without = s;
  with.levels = without.levels = level + 1;
  without.noise.resize(level);
  const auto a = all(Fractal(with)), b = all(Fractal(without));
  const Vec3i n = with.size();
  double sum = 0, square = 0, most = 0, count = 0;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        if (x % 2 == 0 && y % 2 == 0 && z % 2 == 0) continue;
        const double d = double{a[place(n, x, y, z)]} - b[place(n, x, y, z)];
        sum += d, square += d * d, most = std::max(most, std::abs(d)), ++count;
      }
  const double mean = sum / count;
  return {mean, square / count - mean * mean, most};
}

TEST(Fractal, NoiseHasTheVarianceOfItsLevel) {
  const FractalSettings s = rough({2, 2, 1}, 6, 0.9);
  for (int level = 2; level < 6; ++level) {
    const double amplitude = 0.9 * std::pow(0.5, level);
    const Added a = added(s, level);
    const double n = std::pow(8.0, level + 1) * 4 * 7 / 8;
    EXPECT_LE(a.most, amplitude * 1.00001);
    EXPECT_NEAR(a.mean, 0, 5 * amplitude / std::sqrt(3 * n)) << level;
    // Uniform noise: a third of the square; its square varies by 4/45 of the fourth power.
    EXPECT_NEAR(a.variance / (amplitude * amplitude), 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n)) << level;
  }
}

TEST(Fractal, NoiseOfNeighboursAndLevelsIsIndependent) {
  FractalSettings s = plane({16, 16, 16}, 1);
  std::fill(s.coarse.begin(), s.coarse.end(), 0.0f);
  s.noise = {1};
  const auto v = all(Fractal(s));
  s.seed = 1;
  const auto other = all(Fractal(s));
  const Vec3i n = s.size();
  double across[4] = {}, square = 0;
  int count = 0;
  for (int z = 1; z + 1 < n.z; z += 2)
    for (int y = 1; y + 1 < n.y; ++y)
      for (int x = 1; x + 1 < n.x; ++x) {
        const double own = v[place(n, x, y, z)];
        across[0] += own * v[place(n, x + 1, y, z)];
        across[1] += own * v[place(n, x, y + 1, z)];
        across[2] += own * v[place(n, x + 1, y - 1, z)];
        across[3] += own * other[place(n, x, y, z)];
        square += own * own, ++count;
      }
  for (double a : across) EXPECT_NEAR(a / square, 0, 5 / std::sqrt(count));
}

TEST(Fractal, LooksTheSameUpsideDownOnAverage) {
  double above = 0, samples = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    FractalSettings s = rough({2, 2, 1}, 4, 1.2);
    s.seed = seed;
    for (float v : all(Fractal(s))) above += v > 0, ++samples;
  }
  EXPECT_NEAR(above / samples, 0.5, 0.03);
}

/// Greatest second difference along x over the grid's spacing squared.
double bend(const FractalSettings& s) {
  const auto v = all(Fractal(s));
  const Vec3i n = s.size();
  double most = 0;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 1; x + 1 < n.x; ++x)
        most = std::max(most, std::abs(v[place(n, x - 1, y, z)] - 2 * double{v[place(n, x, y, z)]} +
                                       v[place(n, x + 1, y, z)]));
  return most;
}

TEST(Fractal, SmoothLastLevelsBendLittle) {
  FractalSettings s = rough({2, 2, 1}, 6);
  const double jagged = bend(s);
  s.noise = decaying_noise(0.7, 0.5, 6, 2);
  const double smooth = bend(s);
  // What bends now is level 3, spread over four samples. Averages of the two nearest would leave creases
  // there: a quarter of its second differences at least.
  FractalSettings before = s;
  before.levels = 4;
  const double level3 = bend(before);
  EXPECT_LT(smooth, 0.25 * level3);
  EXPECT_LT(smooth, 0.6 * jagged);
}

TEST(Fractal, MeetsItsPins) {
  FractalSettings s = rough({2, 2, 1}, 6, 0.5);
  s.spacing = 0.5;
  s.origin = {100, -50, 7};
  const Vec3d hill{100 + 0.5 * 40, -50 + 0.5 * 72, 7 + 0.5 * 48};
  const Vec3d hole{100 + 0.5 * 96, -50 + 0.5 * 16, 7 + 0.5 * 16};
  s.pins = {{hill, 0.8, 8, 3}, {hole, -0.9, 0, 3}};
  const Fractal f(s);
  const ScalarGrid grid = f.grid();
  EXPECT_EQ(grid.value(hill), 0.8f);
  EXPECT_EQ(grid.value(hole), -0.9f);
  FractalSettings bare = s;
  bare.pins.clear();
  const ScalarGrid without = Fractal(bare).grid();
  EXPECT_LT(without.value(hill), 0.3f);
  EXPECT_GT(grid.value(hill + Vec3d{1.5, 0, 0}), without.value(hill + Vec3d{1.5, 0, 0}));
  // Far away nothing changes.
  const Vec3d far{100 + 0.5 * 100, -50 + 0.5 * 100, 7 + 0.5 * 30};
  EXPECT_EQ(grid.value(far), without.value(far));
}

// A pin's value holds where others draw, at its level and at later ones.
TEST(Fractal, PinsBesideEachOtherAreAllMet) {
  FractalSettings s = rough({2, 2, 1}, 6, 0.5);
  const Vec3d hill{40, 72, 48}, near{48, 72, 48}, fine{42, 72, 48};
  s.pins = {{hill, 0.8, 30, 3}, {near, -0.9, 30, 3}, {fine, 0.1, 10, 5}};
  const ScalarGrid grid = Fractal(s).grid();
  EXPECT_EQ(grid.value(hill), 0.8f);
  EXPECT_EQ(grid.value(near), -0.9f);
  EXPECT_EQ(grid.value(fine), 0.1f);
}

TEST(Fractal, ALimitSavesMemoryAndChangesNothingElse) {
  FractalSettings s = rough({4, 4, 2}, 6, 0.1);
  const ScalarGrid free = Fractal(s).grid();
  s.limit = 0.25;
  const ScalarGrid limited = Fractal(s).grid();
  const Vec3i n = s.size();
  EXPECT_LT(limited.full_chunks(), free.full_chunks() / 2);
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const Vec3i at{draw_index(random, n.x), draw_index(random, n.y), draw_index(random, n.z)};
    ASSERT_EQ(limited.at(at), std::clamp(free.at(at), -0.25f, 0.25f));
  }
}

TEST(Fractal, HalfPrecisionRoundsAndTakesHalf) {
  const FractalSettings s = rough({2, 2, 1}, 5);
  const ScalarGrid single = Fractal(s).grid(), half = Fractal(s).grid(Precision::half);
  EXPECT_LT(half.bytes(), single.bytes() * 6 / 10);
  for (int i = 0; i < 60; ++i) EXPECT_NEAR(half.at({i, 3, 20}), single.at({i, 3, 20}), 2e-3f);
}

TEST(Fractal, RefusesWhatIsWrong) {
  const auto refused = [](auto&& change, const char* sentence) {
    FractalSettings s = plane({2, 2, 1}, 3);
    change(s);
    EXPECT_THAT(error_of([&] { Fractal f(s); }), HasSubstr(sentence));
  };
  refused([](FractalSettings& s) { s.coarse.pop_back(); }, "2 x 2 x 1 cells needs 18 values, not 17");
  refused([](FractalSettings& s) { s.coarse[3] = NAN; }, "values must be finite");
  refused([](FractalSettings& s) { s.cells.y = 0; }, "at least one cell a side, not 2 x 0 x 1");
  refused([](FractalSettings& s) { s.levels = 0; }, "1 to 20 times, not 0");
  refused([](FractalSettings& s) { s.levels = 20; }, "samples is too large; take fewer levels");
  refused([](FractalSettings& s) { s.noise = {-1}; }, "its noise 0 or more");
  refused([](FractalSettings& s) { s.spacing = 0; }, "spacing and limit must be positive lengths");
  refused([](FractalSettings& s) { s.pins = {{{}, 1, 1, 3}}; }, "a pin's level must be from 0 to 2");
}

}  // namespace
}  // namespace tafoni::volume
