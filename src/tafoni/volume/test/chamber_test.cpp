#include "tafoni/volume/chamber.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

Chamber chamber_of(const char* name, double noise = 0, double turn = 0) {
  ChamberSettings s;
  s.noise = noise;
  s.turn = turn;
  s.cell = find_chamber_preset(name).cell;
  return Chamber(parse_lattice(find_chamber_preset(name).lattice, name), s);
}

/// A place in cells from the middle of the floor's layer.
Vec3d at(const Chamber& c, double x, double y, double z) {
  return c.settings().position + Vec3d{x, y, z} * c.settings().cell;
}

TEST(Chamber, StorageRoomHasItsColumnsAndItsBulge) {
  const Chamber c = chamber_of("storage");
  for (double x : {-2.0, 2.0})
    for (double y : {-2.0, 2.0})
      for (double z = 0.2; z < 5.9; z += 0.1)
        EXPECT_GT(c.value(at(c, x, y, z)), 0) << "column " << x << y << z;
  // The bulge: rock in the middle of the ceiling, room beneath.
  EXPECT_GT(c.value(at(c, 0, 0, 3.5)), 0);
  for (double z = 0.7; z < 2.2; z += 0.1) EXPECT_LT(c.value(at(c, 0, 0, z)), 0);
  // All the way round the columns one can walk.
  for (double t = -3.5; t <= 3.5; t += 0.1)
    for (double z : {0.8, 1.3}) {
      EXPECT_LT(c.value(at(c, t, 3.5, z)), 0);
      EXPECT_LT(c.value(at(c, -3.5, t, z)), 0);
      EXPECT_LT(c.value(at(c, t, 0, z)), 0);
    }
  // Room higher than the bulge beside it.
  EXPECT_LT(c.value(at(c, 0, 4, 4.5)), 0);
}

TEST(Chamber, QueensChamberHasFourBulgesAboveAPlatform) {
  const Chamber c = chamber_of("queen");
  EXPECT_GT(c.value(at(c, 0, 0, 1.2)), 0) << "the platform";
  EXPECT_LT(c.value(at(c, 0, 0, 1.9)), 0);
  EXPECT_LT(c.value(at(c, 4.5, 0, 0.8)), 0) << "the floor about it";
  for (double x : {-2.0, 2.0})
    for (double y : {-2.0, 2.0}) {
      for (double z = 4; z < 7; z += 0.1) EXPECT_GT(c.value(at(c, x, y, z)), 0) << "a bulge";
      EXPECT_LT(c.value(at(c, x, y, 2.3)), 0) << "room beneath it";
    }
  for (double z = 2; z < 5.5; z += 0.1) EXPECT_LT(c.value(at(c, 0, 0, z)), 0) << "between the bulges";
}

TEST(Chamber, NoPresetLeavesItsBorderWhateverTheNoise) {
  for (const ChamberPreset& preset : chamber_presets()) {
    const Chamber c = chamber_of(preset.name.c_str(), 1.5, 0.4);
    const Box3d box = c.bounds();
    Random random(2);
    for (int i = 0; i < 20000; ++i) {
      const Box3d around = box.grown(3);
      const Vec3d p{random.uniform(around.lo.x, around.hi.x), random.uniform(around.lo.y, around.hi.y),
                    random.uniform(around.lo.z, around.hi.z)};
      if (c.value(p) <= 0) {
        ASSERT_TRUE(box.contains(p)) << preset.name;
      }
    }
  }
}

TEST(Chamber, WithoutNoiseItIsSmoothAndTurns) {
  const Chamber c = chamber_of("queen"), noisy = chamber_of("queen", 0.3),
                turned = chamber_of("queen", 0, 0.7);
  const auto bend = [](const ScalarGrid& g) {
    double most = 0;
    const Vec3i n = g.frame().size;
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 1; x + 1 < n.x; ++x)
          most = std::max<double>(most,
                                  std::abs(g.at({x - 1, y, z}) - 2 * g.at({x, y, z}) + g.at({x + 1, y, z})));
    return most;
  };
  // Over a cell values swing by two half cells at most: the four-point rule bends them by as much over one
  // cell, and here a cell has 8 samples.
  EXPECT_LT(bend(c.grid()), 2.6 * 2 * 4.0 / 64 * 2);
  EXPECT_GT(bend(noisy.grid()), bend(c.grid()));
  const Vec3d p = at(c, 2.2, -1.1, 3.3);
  const double co = std::cos(0.7), si = std::sin(0.7);
  EXPECT_NEAR(turned.value({co * p.x - si * p.y, si * p.x + co * p.y, p.z}), c.value(p), 1e-5);
}

TEST(Chamber, OpenSpaceOnlyGrows) {
  const Chamber c = chamber_of("hall", 0.2);
  ScalarGrid grid({{-12, -12, -4}, 0.7, {40, 37, 31}}, 3);
  grid.edit(grid.samples(), [](Vec3i first, std::span<float> row) {
    if (first.z == 12) std::fill(row.begin(), row.end(), -5.0f);
  });
  const ScalarGrid before = grid;
  EXPECT_FALSE(carve(grid, c).empty());
  const GridFrame frame = grid.frame();
  for (int z = 0; z < 31; ++z)
    for (int y = 0; y < 37; ++y)
      for (int x = 0; x < 40; ++x) {
        const Vec3d p = frame.position({x, y, z});
        ASSERT_LE(grid.at({x, y, z}), before.at({x, y, z}));
        if (c.bounds().contains(p)) {
          ASSERT_EQ(grid.at({x, y, z}), std::min(before.at({x, y, z}), static_cast<float>(c.value(p))));
        } else if (!c.bounds().grown(1).contains(p)) {
          ASSERT_EQ(grid.at({x, y, z}), before.at({x, y, z}));
        }
      }
}

TEST(Chamber, ReadsLatticesInWordsAndNumbers) {
  const ChamberLattice a = parse_lattice("#+/o-/..;##/##/##", "here"),
                       b = parse_lattice("1 .5\n0 -0.5\n-1 -1;\n1 1\n1 1\n1 1\n", "here");
  EXPECT_EQ(a.cells, (Vec3i{1, 2, 1}));
  EXPECT_EQ(a.values, b.values);
  // The first row is the northern one.
  EXPECT_THAT(a.values, testing::ElementsAre(-1, -1, 0, -0.5, 1, 0.5, 1, 1, 1, 1, 1, 1));
  const auto error = [](const char* wrong) { return error_of([&] { parse_lattice(wrong, "here"); }); };
  for (const char* small : {"##/##", "1 2 3;1 2 3", ""})
    EXPECT_THAT(error(small), HasSubstr("here: a lattice takes at least 2 x 2 x 2 values")) << small;
  EXPECT_EQ(error("##/#;##/##"), "here: the row \"#\" has 1 values where the first has 2");
  EXPECT_EQ(error("##/##;##"), "here: a layer has 1 rows where the first has 2");
  EXPECT_EQ(error("#x/##;##/##"), "here: \"#x\" is neither a number nor made of # + o - .");
  EXPECT_EQ(error("##/##;1 3e38/##"), "here: 3e+38 is not between -1, which is open, and 1, which is rock");
}

TEST(Chamber, UnknownPresetsGetTheNearest) {
  EXPECT_EQ(error_of([] { find_chamber_preset("qeen"); }),
            "there is no chamber \"qeen\"; did you mean \"queen\"?");
  EXPECT_EQ(error_of([] { find_chamber_preset("dungeon"); }),
            "there is no chamber \"dungeon\"; known are storage, queen, hall");
}

}  // namespace
}  // namespace tafoni::volume
