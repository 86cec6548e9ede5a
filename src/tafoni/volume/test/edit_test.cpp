#include "tafoni/volume/edit.h"

#include <array>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/volume/impl/tool_shape.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

constexpr double amplitude = 2.5;

/// Ground at z = 0, saturated.
ScalarGrid ground(Precision precision = Precision::single) {
  ScalarGrid grid({{-20, -20, -20}, 0.5, {90, 81, 77}}, 0, precision);
  const GridFrame frame = grid.frame();
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (float& v : row) v = static_cast<float>(std::clamp(-frame.position(first).z, -amplitude, amplitude));
  });
  grid.compact();
  return grid;
}

std::vector<Tool> tools() {
  const std::array<Vec3d, 5> corners{Vec3d{-4, -3, -2}, {5, -2, -1}, {0, 6, -3}, {1, 1, 5}, {-3, 4, 2}};
  return {Tool::sphere({1, 2, -1}, 5), Tool::capsule({-6, -6, -6}, {7, 3, 2}, 2.5),
          Tool::box({0, 3, -2}, {4, 2, 5}, 0.4), Tool::hull(corners),
          Tool::sphere({-20, -20, -3}, 4)};  // reaches over the frame's corner
}

bool is_hull(const Tool& tool) {
  return std::holds_alternative<impl::Hull>(tool.shape().solid);
}

double outside(const Box3d& box, Vec3d p) {
  const Vec3d nearest{std::clamp(p.x, box.lo.x, box.hi.x), std::clamp(p.y, box.lo.y, box.hi.y),
                      std::clamp(p.z, box.lo.z, box.hi.z)};
  return length(p - nearest);
}

/// apply() as documented, sample by sample over the whole grid.
float expected(float v, double d, Edit edit) {
  if (d <= -amplitude) return v;
  const auto limited = static_cast<float>(std::min(d, amplitude));
  return edit == Edit::remove ? std::min(v, -limited) : std::max(v, limited);
}

TEST(Edit, ToolsCombineWithEverySampleAsTheirDistanceSays) {
  for (const Tool& tool : tools())
    for (Edit edit : {Edit::remove, Edit::add}) {
      const ScalarGrid before = ground();
      ScalarGrid after = before;
      const SampleBox changed = apply(after, tool, edit, amplitude);
      const Vec3i n = before.frame().size;
      SampleBox differs{n, {-1, -1, -1}};
      for (int z = 0; z < n.z; ++z)
        for (int y = 0; y < n.y; ++y)
          for (int x = 0; x < n.x; ++x) {
            const float was = before.at({x, y, z}), now = after.at({x, y, z});
            const Vec3d p = before.frame().position({x, y, z});
            const double d = tool.distance(p);
            ASSERT_EQ(now, expected(was, is_hull(tool) ? std::min(d, -outside(tool.bounds(), p)) : d, edit));
            if (now == was) continue;
            differs = {{std::min(differs.lo.x, x), std::min(differs.lo.y, y), std::min(differs.lo.z, z)},
                       {std::max(differs.hi.x, x), std::max(differs.hi.y, y), std::max(differs.hi.z, z)}};
          }
      EXPECT_EQ(changed, differs);
    }
}

TEST(Edit, AddingWhatWasRemovedLeavesTheToolSolidAndTheRestAsItWas) {
  const Tool tool = Tool::sphere({0, 0, -8}, 6);
  ScalarGrid grid = ground();
  const ScalarGrid before = grid;
  apply(grid, tool, Edit::remove, amplitude);
  EXPECT_LT(grid.value({0, 0, -8}), 0);
  apply(grid, tool, Edit::add, amplitude);
  const Vec3i n = grid.frame().size;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const double d = tool.distance(grid.frame().position({x, y, z}));
        if (d > 0) {
          ASSERT_GT(grid.at({x, y, z}), 0);
        } else if (d <= -amplitude) {
          ASSERT_EQ(grid.at({x, y, z}), before.at({x, y, z}));
        }
      }
}

TEST(Edit, UniformRockAndAirStayUniform) {
  ScalarGrid grid({{}, 1, {256, 256, 256}}, 2.5f);
  const std::uint64_t none = grid.full_chunks();
  EXPECT_TRUE(apply(grid, Tool::sphere({128, 128, 128}, 30), Edit::add, amplitude).empty());
  EXPECT_EQ(grid.full_chunks(), none);
  apply(grid, Tool::box({128, 128, 128}, {60, 60, 60}), Edit::remove, amplitude);
  grid.compact();
  float middle = 0, corner = 0;
  EXPECT_TRUE(grid.uniform({4, 4, 4}, &middle));
  EXPECT_EQ(middle, -2.5f);
  EXPECT_TRUE(grid.uniform({0, 0, 0}, &corner));
  EXPECT_EQ(corner, 2.5f);
  EXPECT_EQ(grid.range(grid.frame().box()).lo, -2.5f);
}

TEST(Edit, ExplosionsSubtractTheFalloffAndKeepToTheAmplitude) {
  for (double energy : {1.5, 40.0, -1.5, -40.0})
    for (Precision precision : {Precision::single, Precision::half}) {
      const Vec3d center{1.3, -2.2, 0.7};
      const double radius = 6.3;
      ScalarGrid grid = ground(precision);
      const ScalarGrid before = grid;
      const SampleBox changed = explode(grid, center, radius, energy, amplitude);
      EXPECT_FALSE(changed.empty());
      const Vec3i n = grid.frame().size;
      for (int z = 0; z < n.z; ++z)
        for (int y = 0; y < n.y; ++y)
          for (int x = 0; x < n.x; ++x) {
            const double r = length(grid.frame().position({x, y, z}) - center) / radius;
            const double g = r < 1 ? std::pow(1 - r * r, 3) : 0;
            const double truth = std::clamp(before.at({x, y, z}) - energy * g, -amplitude, amplitude);
            ASSERT_NEAR(grid.at({x, y, z}), truth, precision == Precision::half ? 2e-3 : 1e-5);
            if (r >= 1) {
              ASSERT_EQ(grid.at({x, y, z}), before.at({x, y, z}));
            }
          }
    }
}

TEST(Edit, ARadialProfileIsAskedByRadius) {
  ScalarGrid grid = ground(), same = ground();
  const Vec3d center{0, 1, -1};
  add_radial(
      grid, center, 5, [](double r) { return -3 * std::pow(1 - r * r, 3); }, amplitude);
  explode(same, center, 5, 3, amplitude);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p{random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-8, 8)};
    EXPECT_NEAR(grid.value(p), same.value(p), 1e-5);
  }
}

TEST(Edit, ValuesBeyondTheAmplitudeAreNotPulledBack) {
  ScalarGrid grid({{}, 1, {20, 20, 20}}, 9);
  explode(grid, {10, 10, 10}, 6, 1, 2);
  EXPECT_EQ(grid.at({10, 10, 10}), 8);
  explode(grid, {10, 10, 10}, 6, -1, 2);
  EXPECT_EQ(grid.at({10, 10, 10}), 8);
}

TEST(Edit, RefusesWhatIsNotAboveZero) {
  ScalarGrid grid = ground();
  EXPECT_THAT(error_of([&] { apply(grid, Tool::sphere({}, 1), Edit::add, 0); }),
              HasSubstr("amplitude must be above 0 and finite, not 0"));
  EXPECT_THAT(error_of([&] { explode(grid, {}, 0, 1, 1); }),
              HasSubstr("a finite centre and a radius above 0, not 0"));
  EXPECT_THAT(error_of([&] { explode(grid, {NAN, 0, 0}, 1, 1, 1); }), HasSubstr("needs a finite centre"));
  const auto one = [](double) { return 1.0; };
  EXPECT_THAT(error_of([&] { add_radial(grid, {}, 1, one, -1); }),
              HasSubstr("amplitude must be above 0 and finite, not -1"));
}

}  // namespace
}  // namespace tafoni::volume
