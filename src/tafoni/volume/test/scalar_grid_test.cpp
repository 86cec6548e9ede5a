#include "tafoni/volume/scalar_grid.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/half.h"
#include "tafoni/math/whole.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

/// A plain array beside the grid.
struct Mirror {
  GridFrame frame;
  Precision precision;
  std::vector<float> values;

  Mirror(const GridFrame& f, float value, Precision p)
      : frame(f), precision(p), values(std::int64_t{f.size.x} * f.size.y * f.size.z, stored(value)) {}
  float stored(float v) const { return precision == Precision::half ? from_half(to_half(v)) : v; }
  float& at(Vec3i s) { return values[(std::int64_t{s.z} * frame.size.y + s.y) * frame.size.x + s.x]; }
  float nearest(Vec3i s) {
    return at({std::clamp(s.x, 0, frame.size.x - 1), std::clamp(s.y, 0, frame.size.y - 1),
               std::clamp(s.z, 0, frame.size.z - 1)});
  }
};

template <class F>
void for_samples(const SampleBox& box, const F& visit) {
  for (int z = box.lo.z; z <= box.hi.z; ++z)
    for (int y = box.lo.y; y <= box.hi.y; ++y)
      for (int x = box.lo.x; x <= box.hi.x; ++x) visit(Vec3i{x, y, z});
}

SampleBox random_box(Random& random, Vec3i size, int side) {
  const auto below = [&](int n) { return draw_index(random, n); };
  SampleBox box;
  box.lo = {below(size.x), below(size.y), below(size.z)};
  box.hi = {std::min(size.x - 1, box.lo.x + below(side)), std::min(size.y - 1, box.lo.y + below(side)),
            std::min(size.z - 1, box.lo.z + below(side))};
  return box;
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

void expect_same(const ScalarGrid& grid, const Mirror& mirror) {
  std::vector<float> all(mirror.values.size());
  grid.read(grid.samples(), all.data());
  ASSERT_TRUE(std::equal(all.begin(), all.end(), mirror.values.begin(), same_bits));
}

Interval brute_range(Mirror& mirror, const SampleBox& box) {
  Interval range{mirror.at(box.lo), mirror.at(box.lo)};
  for_samples(box, [&](Vec3i s) {
    range.lo = std::min(range.lo, mirror.at(s));
    range.hi = std::max(range.hi, mirror.at(s));
  });
  return range;
}

Box3d random_place(Random& random, const GridFrame& frame, double side) {
  const Vec3d lo{random.uniform(-5, frame.size.x + 3), random.uniform(-5, frame.size.y + 3),
                 random.uniform(-5, frame.size.z + 3)};
  const Vec3d size{random.uniform(0, side), random.uniform(0, side), random.uniform(0, side)};
  return {frame.origin + lo * frame.spacing, frame.origin + (lo + size) * frame.spacing};
}

void expect_ranges(const ScalarGrid& grid, Mirror& mirror, Random& random) {
  for (int i = 0; i < 20; ++i) {
    const bool small = i & 1;
    const Box3d box = random_place(random, grid.frame(), small ? 16 : 80);
    const Interval range = grid.range(box);
    const SampleBox samples = grid.samples_in(box);
    if (!samples.empty()) {
      const Interval truth = brute_range(mirror, samples);
      if (small) {
        ASSERT_EQ(range.lo, truth.lo);
        ASSERT_EQ(range.hi, truth.hi);
      }
      ASSERT_LE(range.lo, truth.lo);
      ASSERT_GE(range.hi, truth.hi);
    }
    for (int k = 0; k < 20; ++k) {
      const Vec3d p{random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                    random.uniform(box.lo.z, box.hi.z)};
      ASSERT_TRUE(range.contains(grid.value(p)));
    }
  }
}

/// 100,000 random edits a precision, through every way of editing, beside a plain array.
void edit_at_random(Precision precision) {
  const GridFrame frame{{-3, 10, 2}, 0.25, {70, 45, 50}};
  ScalarGrid grid(frame, -1.3f, precision);
  Mirror mirror(frame, -1.3f, precision);
  Random random(7, static_cast<std::uint64_t>(precision));
  std::vector<std::pair<ScalarGrid, Mirror>> snapshots;
  std::vector<float> values;
  for (int step = 0; step < 100000; ++step) {
    const SampleBox box = random_box(random, frame.size, step % 500 == 0 ? 60 : 4);
    const auto change = [&](Vec3i s, float old) {
      const std::uint64_t h = hash_combine(step, hash_combine(s.x, s.y * 1000 + s.z));
      if (step % 5 == 0) return 2.5f;
      return h % 3 ? old : static_cast<float>(unit_real(h) * 200 - 100);
    };
    if (step % 2) {
      values.clear();
      for_samples(box,
                  [&](Vec3i s) { values.push_back(mirror.at(s) = mirror.stored(change(s, mirror.at(s)))); });
      grid.write(box, values.data());
    } else {
      SampleBox expected;
      bool any = false;
      for_samples(box, [&](Vec3i s) {
        const float now = mirror.stored(change(s, mirror.at(s)));
        if (same_bits(now, mirror.at(s))) return;
        mirror.at(s) = now;
        if (!any) expected = {s, s};
        any = true;
        expected = {
            {std::min(expected.lo.x, s.x), std::min(expected.lo.y, s.y), std::min(expected.lo.z, s.z)},
            {std::max(expected.hi.x, s.x), std::max(expected.hi.y, s.y), std::max(expected.hi.z, s.z)}};
      });
      const SampleBox got = grid.edit(box, [&](Vec3i first, std::span<float> row) {
        for (int i = 0; i < std::ssize(row); ++i) row[i] = change({first.x + i, first.y, first.z}, row[i]);
      });
      ASSERT_EQ(got, expected);
    }
    if (step % 1000 == 999) {
      if (step % 3000 == 2999) grid.compact();
      expect_same(grid, mirror);
      expect_ranges(grid, mirror, random);
    }
    if (step % 17000 == 0) snapshots.emplace_back(grid, mirror);
  }
  for (auto& [snapshot, then] : snapshots) {
    expect_same(snapshot, then);
    expect_ranges(snapshot, then, random);
  }
}

TEST(ScalarGrid, RandomEditsAgreeWithAPlainArray) {
  edit_at_random(Precision::single);
}

TEST(ScalarGrid, RandomEditsAgreeWithAPlainArrayInHalfPrecision) {
  edit_at_random(Precision::half);
}

TEST(ScalarGrid, ReadsBeyondTheFrameGiveTheNearestSample) {
  const GridFrame frame{{}, 1, {37, 20, 9}};
  for (Precision precision : {Precision::single, Precision::half}) {
    ScalarGrid grid(frame, 0, precision);
    Mirror mirror(frame, 0, precision);
    Random random(3);
    for (float& v : mirror.values) v = mirror.stored(draw_float(random, -3, 3));
    grid.write(grid.samples(), mirror.values.data());
    for (const SampleBox& box : {SampleBox{{-7, -3, -2}, {45, 26, 12}}, SampleBox{{-9, 2, 3}, {-4, 5, 5}},
                                 SampleBox{{37, 19, 8}, {44, 23, 10}}, SampleBox{{30, 5, 5}, {34, 5, 5}}}) {
      std::vector<float> out(box.count());
      grid.read(box, out.data());
      std::size_t i = 0;
      for_samples(box, [&](Vec3i s) {
        ASSERT_EQ(out[i++], mirror.nearest(s));
        ASSERT_EQ(grid.at(s), mirror.nearest(s));
      });
    }
  }
}

TEST(ScalarGrid, ValuesAreTrilinear) {
  const GridFrame frame{{100, -20, 5}, 0.5, {40, 35, 66}};
  for (Precision precision : {Precision::single, Precision::half}) {
    ScalarGrid grid(frame, 0, precision);
    Mirror mirror(frame, 0, precision);
    Random random(4);
    for (float& v : mirror.values) v = mirror.stored(draw_float(random, -3, 3));
    grid.write(grid.samples(), mirror.values.data());
    std::vector<Vec3d> points;
    for (int i = 0; i < 20000; ++i) {
      const Vec3d u{random.uniform(-3, 43), random.uniform(-3, 38), random.uniform(-3, 69)};
      points.push_back(frame.origin + u * frame.spacing);
    }
    std::vector<float> values(points.size());
    std::vector<Vec3f> gradients(points.size());
    grid.values(points, values);
    grid.gradients(points, gradients);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d u = (points[i] - frame.origin) * (1 / frame.spacing);
      const auto weight = [](double x, int n, int s) {
        const double at = std::clamp(x, 0.0, n - 1.0);
        return std::max(0.0, 1 - std::abs(at - s));
      };
      const auto slope = [](double x, int n, int s) {
        if (x < 0 || x > n - 1) return 0.0;
        const int cell = std::min(floor_to(x), n - 2);
        return s == cell ? -1.0 : s == cell + 1 ? 1.0 : 0.0;
      };
      double truth = 0;
      Vec3d gradient;
      const auto first = [](double x, int n) { return std::clamp(floor_to(x), 0, n - 2); };
      const Vec3i c{first(u.x, frame.size.x), first(u.y, frame.size.y), first(u.z, frame.size.z)};
      for_samples({c, c + Vec3i{1, 1, 1}}, [&](Vec3i s) {
        const double v = mirror.at(s);
        const double x = weight(u.x, frame.size.x, s.x), y = weight(u.y, frame.size.y, s.y),
                     z = weight(u.z, frame.size.z, s.z);
        truth += v * x * y * z;
        gradient += Vec3d{slope(u.x, frame.size.x, s.x) * y * z, x * slope(u.y, frame.size.y, s.y) * z,
                          x * y * slope(u.z, frame.size.z, s.z)} *
                    (v / frame.spacing);
      });
      ASSERT_NEAR(values[i], truth, 1e-5);
      ASSERT_NEAR(length(to_double(gradients[i]) - gradient), 0, 1e-4);
      ASSERT_EQ(grid.value(points[i]), values[i]);
    }
  }
}

TEST(ScalarGrid, LatticePointsHaveTheSampleItself) {
  const GridFrame frame{{8, -16, 4}, 0.25, {34, 5, 6}};
  ScalarGrid grid(frame, 0);
  Random random(5);
  std::vector<float> values(34 * 5 * 6);
  for (float& v : values) v = draw_float(random, -1, 1);
  grid.write(grid.samples(), values.data());
  for_samples(grid.samples(), [&](Vec3i s) { EXPECT_EQ(grid.value(frame.position(s)), grid.at(s)); });
}

TEST(ScalarGrid, UniformChunksStayOneValueAndComeBack) {
  const GridFrame frame{{}, 1, {100, 100, 100}};
  ScalarGrid grid(frame, -4);
  EXPECT_EQ(grid.full_chunks(), 0u);
  EXPECT_TRUE(grid.edit(grid.samples(), [](Vec3i, std::span<float>) {}).empty());
  EXPECT_EQ(grid.full_chunks(), 0u);
  grid.edit({{31, 40, 40}, {32, 40, 40}}, [](Vec3i, std::span<float> row) { row[0] = 1; });
  EXPECT_EQ(grid.full_chunks(), 2u);
  float value = 0;
  EXPECT_FALSE(grid.uniform({0, 1, 1}));
  ASSERT_NE(grid.chunk({1, 1, 1}), nullptr);
  EXPECT_EQ(grid.chunk({1, 1, 1})[(8 * 32 + 8) * 32], 1);
  ASSERT_TRUE(grid.uniform({3, 3, 3}, &value));
  EXPECT_EQ(value, -4);
  const std::uint64_t full = grid.bytes();
  grid.edit({{31, 40, 40}, {32, 40, 40}}, [](Vec3i, std::span<float> row) { row[0] = -4; });
  EXPECT_EQ(grid.full_chunks(), 2u);
  grid.compact();
  EXPECT_EQ(grid.full_chunks(), 0u);
  EXPECT_LT(grid.bytes() + 2 * 128 * 1024, full + 1);
  EXPECT_EQ(grid, ScalarGrid(frame, -4));
}

TEST(ScalarGrid, AnExceptionInAnEditLeavesRangesRight) {
  ScalarGrid grid({{}, 1, {40, 40, 40}}, 0);
  const auto write_some = [](Vec3i first, std::span<float> row) {
    row[3] = 9;
    if (first.y == 5) fail(ErrorKind::cancelled, "row five");
  };
  EXPECT_EQ(error_of([&] { grid.edit(grid.samples(), write_some); }), "row five");
  EXPECT_EQ(grid.at({3, 4, 0}), 9);
  EXPECT_EQ(grid.range(grid.frame().box()).hi, 9);
}

TEST(ScalarGrid, CopiesAreReadWhileTheOriginalIsEdited) {
  const GridFrame frame{{}, 1, {70, 40, 40}};
  ScalarGrid grid(frame, 0);
  std::vector<std::thread> readers;
  std::atomic<int> wrong{0};
  for (int step = 1; step <= 60; ++step) {
    // Every sample of a copy has one value, and those of the next copy another.
    const auto value = static_cast<float>(step);
    grid.edit(grid.samples(), [&](Vec3i, std::span<float> row) { std::fill(row.begin(), row.end(), value); });
    readers.emplace_back([copy = grid, value, &wrong] {
      const Interval range = copy.range(copy.frame().box());
      wrong += range.lo != value || range.hi != value;
      std::vector<float> all(70 * 40 * 40);
      copy.read(copy.samples(), all.data());
      for (float v : all) wrong += v != value;
    });
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
}

TEST(ScalarGrid, EqualityIsByBits) {
  const GridFrame frame{{}, 1, {40, 8, 8}};
  ScalarGrid a(frame, 0), b(frame, 0), c(frame, -0.f);
  EXPECT_EQ(a, b);
  EXPECT_FALSE(a == c);
  EXPECT_FALSE(a == ScalarGrid(frame, 0, Precision::half));
  EXPECT_FALSE(a == ScalarGrid({{}, 2, {40, 8, 8}}, 0));
  const float one = 1, zero = 0;
  a.write({{39, 7, 7}, {39, 7, 7}}, &one);
  EXPECT_FALSE(a == b);
  a.write({{39, 7, 7}, {39, 7, 7}}, &zero);
  EXPECT_EQ(a, b);
}

TEST(ScalarGrid, SamplesInABoxAreThoseOfTheCellsItTouches) {
  const ScalarGrid grid({{10, 20, 30}, 2, {11, 12, 13}}, 0);
  EXPECT_EQ(grid.samples_in({{12.1, 22, 31}, {12.2, 22, 33}}), (SampleBox{{1, 1, 0}, {2, 2, 2}}));
  EXPECT_EQ(grid.samples_in(Box3d::everything()), grid.samples());
  EXPECT_TRUE(grid.samples_in({{0, 20, 30}, {9, 30, 40}}).empty());
  EXPECT_TRUE(grid.samples_in({}).empty());
}

TEST(ScalarGrid, RefusesWrongFramesAndBoxes) {
  const auto error = [](const GridFrame& frame) { return error_of([&] { ScalarGrid(frame, 0); }); };
  EXPECT_THAT(error({{}, 1, {1, 8, 8}}), HasSubstr("1 x 8 x 8 samples has no cells"));
  EXPECT_THAT(error({{}, 0, {8, 8, 8}}), HasSubstr("its spacing (0) above 0"));
  EXPECT_THAT(error({{}, -1, {8, 8, 8}}), HasSubstr("its spacing (-1) above 0"));
  EXPECT_THAT(error({{}, NAN, {8, 8, 8}}), HasSubstr("its spacing (nan) above 0"));
  EXPECT_THAT(error({{}, 1, {1 << 20, 1 << 20, 2}}), HasSubstr("is too large: at most 2^40 in all"));
  EXPECT_THAT(error({{}, 1, {2, (1 << 30) + 1, 2}}), HasSubstr("is too large: at most 2^40 in all"));
  EXPECT_THAT(error({{0, NAN, 0}, 1, {8, 8, 8}}), HasSubstr("a grid's origin must be finite"));
  ScalarGrid grid({{}, 1, {8, 8, 8}}, 0);
  const float values[2] = {1, 2};
  EXPECT_EQ(error_of([&] {
              grid.write({{7, 0, 0}, {8, 0, 0}}, values);
            }),
            "samples (7, 0, 0) to (8, 0, 0) are written, which the grid does not have");
}

TEST(ScalarGrid, FillGivesMemoryBack) {
  for (const Precision precision : {Precision::single, Precision::half}) {
    ScalarGrid grid({{0, 0, 0}, 1, {70, 64, 40}}, 1, precision);
    grid.edit(grid.samples(), [](Vec3i first, std::span<float> row) {
      for (int i = 0; i < std::ssize(row); ++i) row[i] = static_cast<float>(first.x + first.y + first.z + i);
    });
    const ScalarGrid before = grid;
    const SampleBox box{{5, 0, 0}, {69, 63, 35}};
    grid.fill(box, 0.1f);
    const float expected = precision == Precision::single ? 0.1f : from_half(to_half(0.1f));
    for (int z = 0; z < 40; ++z)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 70; ++x)
          ASSERT_EQ(grid.at({x, y, z}), x >= 5 && z <= 35 ? expected : before.at({x, y, z}));
    EXPECT_EQ(before.full_chunks(), 12u);
    EXPECT_EQ(grid.full_chunks(), 8u);  // those with x < 5 or z > 35 in them
    const Interval range = grid.range(grid.frame().box());
    EXPECT_LE(range.lo, 0);
    EXPECT_EQ(range.hi, before.at({69, 63, 39}));
  }
}

TEST(ScalarGrid, ChunksThatShareAreEditedApart) {
  ScalarGrid grid({{0, 0, 0}, 1, {96, 32, 40}}, 1);
  grid.edit({{3, 4, 5}, {6, 7, 8}}, [](Vec3i, std::span<float> row) { row[0] = 7; });
  grid.share({0, 0, 0}, {2, 0, 0});
  EXPECT_EQ(grid.at({67, 4, 5}), 7);
  EXPECT_EQ(grid.at({66, 4, 5}), 1);
  grid.fill({{64, 0, 0}, {70, 31, 31}}, -2);
  EXPECT_EQ(grid.at({67, 4, 5}), -2);
  EXPECT_EQ(grid.at({3, 4, 5}), 7);
  grid.share({1, 0, 0}, {0, 0, 0});
  EXPECT_TRUE(grid.uniform({0, 0, 0}));
  EXPECT_THROW(grid.share({0, 0, 0}, {0, 0, 1}), Error);  // of fewer samples
}

}  // namespace
}  // namespace tafoni::volume
