#include "tafoni/render/inner/palette.h"

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/math/draw.h"

namespace tafoni::render {
namespace {

GroundLook random_point(Random& random) {
  GroundLook s;
  s.position = {random.uniform(-500, 500), random.uniform(-500, 500), random.uniform(-100, 300)};
  s.normal = to_float(normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}));
  s.resistance = draw_float(random, 0, 1);
  s.height_above_sea = draw_float(random, -20, 200);
  s.roofed = random.below(2) == 1;
  s.spacing = draw_float(random, 0.1, 30);
  return s;
}

/// The mean over many places, so that the texture does not matter.
Vec3f mean(GroundLook s) {
  Random random(3);
  Vec3f sum;
  for (int i = 0; i < 400; ++i) {
    s.position = {random.uniform(-900, 900), random.uniform(-900, 900), random.uniform(-90, 90)};
    sum += rock_palette(s);
  }
  return sum * (1.0f / 400);
}

TEST(Palette, IsAReflectanceEverywhere) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3f c = rock_palette(random_point(random));
    for (const float v : {c.x, c.y, c.z}) {
      ASSERT_GT(v, 0.005f);
      ASSERT_LT(v, 0.8f);
    }
  }
}

TEST(Palette, GrassIsGreenAndOnlyOnOpenTreads) {
  const Vec3f top = mean({});
  EXPECT_GT(top.y, 1.5f * top.z);
  EXPECT_GT(top.y, 0.9f * top.x);
  const Vec3f cliff = mean({.position = {}, .normal = {1, 0, 0}});
  EXPECT_LT(cliff.y, cliff.x);
  EXPECT_GT(cliff.x + cliff.y + cliff.z, top.x + top.y + top.z);
  const Vec3f cave = mean({.position = {}, .normal = {0, 0, 1}, .roofed = true});
  EXPECT_LT(cave.y, 0.8f * cave.x);
}

TEST(Palette, SoftRockIsWarmerThanHardRock) {
  const Vec3f soft = mean({.position = {}, .normal = {1, 0, 0}, .resistance = 0});
  const Vec3f hard = mean({.position = {}, .normal = {1, 0, 0}, .resistance = 1});
  EXPECT_GT(soft.x / soft.z, 1.4f * hard.x / hard.z);
}

TEST(Palette, TheShoreIsDarkAndFlatsAreSand) {
  const Vec3f dry = mean({.position = {}, .normal = {1, 0, 0}, .height_above_sea = 30});
  const Vec3f wet = mean({.position = {}, .normal = {1, 0, 0}, .height_above_sea = -0.5f});
  EXPECT_LT(wet.x, 0.6f * dry.x);
  const Vec3f beach = mean({.position = {}, .normal = {0, 0, 1}, .height_above_sea = 2.2f});
  EXPECT_GT(beach.x, 0.25f);
}

TEST(Palette, CoarseMeshesGetNoTextureThatTheyCannotHold) {
  GroundLook a{.position = {10, 20, 30}, .normal = {1, 0, 0}, .spacing = 1000};
  GroundLook b = a;
  b.position = {-777, 432, 99};
  EXPECT_EQ(rock_palette(a), rock_palette(b));
  a.spacing = b.spacing = 0.5f;
  EXPECT_NE(rock_palette(a), rock_palette(b));
}

TEST(Palette, BytesRound) {
  EXPECT_EQ(to_rgba8({0, 0.5f, 1}), (std::array<std::uint8_t, 4>{0, 128, 255, 255}));
  EXPECT_EQ(to_rgba8({-1, 2, 0.1f}), (std::array<std::uint8_t, 4>{0, 255, 26, 255}));
}

}  // namespace
}  // namespace tafoni::render
