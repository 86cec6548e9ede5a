#include <gtest/gtest.h>

#include "tafoni/core/test/rounds.h"
#include "tafoni/landforms/karst/passages.h"
#include "tafoni/landforms/karst/percolation.h"
#include "tafoni/landforms/test/flood.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

Result karst(const Site& site, Values values = {}) {
  return find_landform("karst").generate(site, values, silent());
}

/// Beds of soft and hard rock, 6 m each.
double beds(Vec3d p) {
  return std::fmod(p.z + 600, 12) < 6 ? 0.1 : 0.7;
}

struct Ways : impl::PercolationSettings, impl::PercolationSpace {
  Ways() { steepness = 0.4; }
};

TEST(Percolation, KeepsItsRules) {
  const Coast coast(beds);
  const auto field = field::compile(coast.site.terrain);
  const impl::Ground ground(coast.site);
  Ways s;
  s.spacing = 4;
  s.cover = 3;
  s.depth = 20;
  s.resistance = 0.5;
  s.points_per_seed = 200;
  s.seed = 1;
  const impl::Entrances entrances{.seeds = {{-20, 20, 30}, {20, 20, 30}}, .springs = {}};
  const auto made = impl::percolate(field, ground, entrances, s, s, silent());
  ASSERT_GT(made.nodes.size(), 30u);
  int soft = 0;
  for (int i = 0; i < std::ssize(made.nodes); ++i) {
    const impl::CaveNode& node = made.nodes[i];
    for (int k = 0; k < i; ++k)
      ASSERT_GE(length(node.position - made.nodes[k].position), s.spacing * 0.999999);
    if (node.parent < 0) continue;
    ASSERT_LT(node.parent, i);
    EXPECT_LE(node.position.z, made.nodes[node.parent].position.z + 1e-9);
    EXPECT_LT(node.resistance, s.resistance);
    EXPECT_GE(node.position.z, 30 - s.depth - 1e-9);
    EXPECT_GT(field.value(node.position + Vec3d{0, 0, s.cover}), 0);
    soft += node.resistance < 0.3;
  }
  EXPECT_GT(soft, 0);
  s.resistance = 0;
  EXPECT_EQ(impl::percolate(field, ground, entrances, s, s, silent()).nodes.size(), 2u)
      << "only the seeds themselves";
}

/// Share of the length of the passages that runs where `soft` holds.
template <class Soft>
double share(const Coast& coast, const Ways& s, const std::vector<Vec3d>& seeds, Soft soft) {
  const auto field = field::compile(coast.site.terrain);
  const impl::Ground ground(coast.site);
  impl::PassageSettings shape;
  shape.threshold = 0.1;
  const auto ways = impl::percolate(field, ground, {.seeds = seeds, .springs = {}}, s, s, silent());
  const auto caves =
      impl::make_passages(field, ground, ways, {.radius = 0.2 * s.spacing, .spacing = s.spacing}, shape, 0);
  double in = 0, all = 0;
  for (const impl::Passage& passage : caves.passages)
    for (std::size_t i = 0; i + 1 < passage.line.size(); ++i) {
      const double step = length(passage.line[i + 1] - passage.line[i]);
      all += step;
      in += step * soft(passage.line[i]);
    }
  EXPECT_GT(all, 300);
  return in / all;
}

Ways roomy() {
  Ways s;
  s.spacing = 4;
  s.cover = 3;
  s.depth = 26;
  s.resistance = 0.75;
  s.points_per_seed = 60;
  return s;
}

const std::vector<Vec3d> on_top = {{-40, 22, 30}, {-15, 25, 30}, {12, 20, 30}, {40, 24, 30}};

TEST(Percolation, KeepsToSoftBeds) {
  // One third of the rock is soft. The ways down from bed to bed must cross the hard ones.
  const auto soft = [](Vec3d p) { return std::fmod(p.z + 600, 9) < 3; };
  const Coast coast([&](Vec3d p) { return soft(p) ? 0.1 : 0.7; });
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    auto s = roomy();
    s.seed = seed;
    EXPECT_GT(share(coast, s, on_top, soft), 0.65);
  }
}

TEST(Percolation, KeepsToFaults) {
  // Upright sheets of crushed rock fill a quarter of it.
  const auto crushed = [](Vec3d p) { return std::fmod(p.x + 0.4 * p.y + 600, 16) < 4; };
  const Coast coast([&](Vec3d p) { return crushed(p) ? 0.1 : 0.6; });
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    auto s = roomy();
    s.seed = seed;
    EXPECT_GT(share(coast, s, on_top, crushed), 0.6);
  }
}

TEST(Percolation, UniformRockShowsNoPreference) {
  const auto soft = [](Vec3d p) { return std::fmod(p.z + 600, 9) < 3; };
  const Coast coast([](Vec3d) { return 0.3; });
  auto s = roomy();
  EXPECT_NEAR(share(coast, s, on_top, soft), 0.33, 0.15);
}

TEST(Karst, WaterComesToLightAtSprings) {
  Coast coast(beds);
  coast.site.points = {{0, 30, 30}};
  const Vec3d spring{12, 0.3, 8};
  const Vec3d world = spring + coast.site.origin;
  const Result result = karst(coast.site, {{"sinks", std::int64_t{0}},
                                           {"faces", std::int64_t{0}},
                                           {"springs", std::vector<double>{world.x, world.y, world.z}}});
  EXPECT_EQ(test::fact<std::int64_t>(result, "networks"), 1);
  EXPECT_EQ(test::fact<std::int64_t>(result, "connected_networks"), 1);
  const auto field = test::carved(coast.site, result);
  double nearest = 1e9;
  for (const Vec3d p : test::fact<Places>(result, "entrance_positions").local)
    nearest = std::min(nearest, length(p - spring));
  EXPECT_LT(nearest, 6) << "on the face beside the place that was named";
}

TEST(Karst, NetworksAreOpenFromEndToEnd) {
  const Coast coast(beds);
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Coast other(beds);
    other.site.seed = seed;
    const Result result = karst(other.site);
    EXPECT_GT(test::fact<std::int64_t>(result, "networks"), 0);
    EXPECT_EQ(test::fact<std::int64_t>(result, "networks"),
              test::fact<std::int64_t>(result, "connected_networks"));
    EXPECT_GT(test::fact<double>(result, "passage_length"), 50);
  }
}

TEST(Karst, LeavesNoClosedVoids) {
  for (int seed = 0; seed < rounds(12); ++seed) {
    Coast coast(beds);
    coast.site.seed = seed;
    const auto field = test::carved(coast.site, karst(coast.site, {{"radius", 2.0}, {"passage", 150.0}}));
    for (const test::Piece& piece : test::pieces(field, {{-60, -45, -15}, {60, 45, 45}}, 0.5, false))
      // A neck between lattice points may part one or two of them from the rest.
      EXPECT_TRUE(piece.at_rim || piece.cells <= 2)
          << piece.cells << " cells at " << piece.first.x << " " << piece.first.y << " " << piece.first.z;
  }
}

TEST(Karst, EntrancesOpenToTheSky) {
  const Coast coast(beds);
  const Result result = karst(coast.site);
  const auto field = test::carved(coast.site, result);
  const auto at = test::fact<Places>(result, "entrance_positions").local;
  ASSERT_EQ(std::ssize(at), test::fact<std::int64_t>(result, "entrances"));
  ASSERT_FALSE(at.empty());
  for (const Vec3d p : at) EXPECT_LT(field.value(p), 0);
}

TEST(Karst, PrefersSoftRock) {
  const auto rho = [](Vec3d p) { return p.x < 0 ? 0.1 : 0.6; };
  Coast coast(rho);
  coast.site.points = {{0, 27, 30}};
  const Result result =
      karst(coast.site, {{"sinks", std::int64_t{0}}, {"faces", std::int64_t{0}}, {"passage", 200.0}});
  const auto before = field::compile(coast.site.terrain), after = test::carved(coast.site, result);
  int soft = 0, hard = 0;
  for (const Vec3d p : test::places({{-55, 8, -10}, {55, 44, 24}}, 60000, 1))
    if (before.value(p) > 0 && after.value(p) <= 0) ++(p.x < 0 ? soft : hard);
  EXPECT_GT(soft, 3 * hard);
  EXPECT_GT(soft, 300);
}

TEST(Karst, StartsAtTheUsersPoints) {
  Coast coast([](Vec3d) { return 0.2; });
  coast.site.points = {{10, 25, 30}};
  const Result result = karst(coast.site, {{"sinks", std::int64_t{0}}, {"faces", std::int64_t{0}}});
  ASSERT_EQ(result.nodes.size(), 1u);
  const auto after = test::carved(coast.site, result);
  EXPECT_LT(after.value({10, 25, 28}), 0);
  EXPECT_TRUE(
      karst(Coast([](Vec3d) { return 0.2; }).site, {{"sinks", std::int64_t{0}}, {"faces", std::int64_t{0}}})
          .nodes.empty());
}

TEST(Karst, HardRockHasNoCaves) {
  const Coast coast([](Vec3d) { return 0.9; });
  EXPECT_TRUE(karst(coast.site).nodes.empty());
}

}  // namespace
}  // namespace tafoni::landforms
