#include "tafoni/landforms/site/surface.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

/// The coast with a cave in its cliff: flats, a face, an overhang and a cave's roof.
field::CompiledField cave() {
  static const test::Coast coast;
  field::CloudSettings tubes;
  tubes.kind = "segment";
  field::CloudBuilder cloud(tubes);
  add_segment(cloud, {0, -4, 6}, {0, 14, 6}, 9, -30);
  return field::compile(field::blend({coast.site.terrain, cloud.finish()}));
}

SurfaceSampling settings(double spacing, std::uint64_t seed) {
  SurfaceSampling s;
  s.spacing = spacing;
  s.box = {{-20, -20, -10}, {20, 25, 40}};
  s.seed = seed;
  return s;
}

TEST(Surface, SamplesAreOnTheSurfaceApartAndLeaveNoHole) {
  const auto field = cave();
  const double spacing = 1.5;
  const auto samples = sample_surface(field, settings(spacing, 1));
  ASSERT_GT(samples.size(), 800u);
  int roof = 0, face = 0, floor = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3d p = samples[i].position;
    EXPECT_NEAR(length(to_double(samples[i].normal)), 1, 1e-4);
    EXPECT_TRUE(settings(spacing, 1).box.contains(p));
    EXPECT_LT(field.value(p + to_double(samples[i].normal) * 0.05),
              field.value(p - to_double(samples[i].normal) * 0.05));
    roof += samples[i].normal.z < -0.7f;
    face += std::abs(samples[i].normal.z) < 0.3f;
    floor += samples[i].normal.z > 0.9f;
    for (std::size_t j = 0; j < i; ++j) ASSERT_GE(length(p - samples[j].position), spacing);
  }
  EXPECT_GT(roof, 30);
  EXPECT_GT(face, 100);
  EXPECT_GT(floor, 100);
  const auto dense = sample_surface(field, settings(0.5, 2));
  for (const SurfaceSample& d : dense) {
    double nearest = 1e9;
    for (const SurfaceSample& s : samples) nearest = std::min(nearest, length(d.position - s.position));
    ASSERT_LT(nearest, 2 * spacing) << d.position.x << ' ' << d.position.y << ' ' << d.position.z;
  }
}

TEST(Surface, IsTheSameWithAnyNumberOfThreads) {
  const auto field = cave();
  set_thread_count(1);
  const auto one = sample_surface(field, settings(1, 3));
  set_thread_count(2);
  const auto two = sample_surface(field, settings(1, 3));
  set_thread_count(0);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i].position, two[i].position);
}

TEST(Surface, TakesOnlyWhatIsAccepted) {
  auto s = settings(1, 3);
  s.accept = [](const SurfaceSample& at) { return at.normal.z < 0; };
  const auto samples = sample_surface(cave(), s);
  ASSERT_FALSE(samples.empty());
  for (const SurfaceSample& at : samples) EXPECT_LT(at.normal.z, 0);
  s.box = {};
  EXPECT_TRUE(sample_surface(cave(), s).empty());
}

TEST(Surface, RefusesASpacingThatNoMachineHolds) {
  auto s = settings(1e-4, 1);
  s.box = {{-1000, -1000, 0}, {1000, 1000, 1}};
  EXPECT_THAT(error_of([&] { sample_surface(cave(), s); }),
              testing::HasSubstr("a spacing of 0.0001 m is too small for a region of 2000 by 2000 m"));
}

}  // namespace
}  // namespace tafoni::landforms
