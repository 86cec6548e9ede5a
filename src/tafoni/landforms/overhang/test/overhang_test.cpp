#include <gtest/gtest.h>

#include "tafoni/landforms/site/surface.h"
#include "tafoni/landforms/test/flood.h"
#include "tafoni/landforms/test/site.h"
#include "tafoni/math/counts.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

Result overhang(const Site& site, Values values = {}) {
  return find_landform("overhang").generate(site, values, silent());
}

/// Share of the surface that looks downwards.
double undercut(const field::CompiledField& field) {
  SurfaceSampling sampling;
  sampling.spacing = 1;
  sampling.box = {{-50, -15, -10}, {50, 15, 45}};
  const auto points = sample_surface(field, sampling);
  std::size_t down = 0;
  for (const SurfaceSample& p : points) down += p.normal.z < -0.05f;
  return ratio(down, points.size());
}

TEST(Overhang, FacesLeanOut) {
  const Coast coast;
  const auto before = field::compile(coast.site.terrain),
             after = test::carved(coast.site, overhang(coast.site));
  EXPECT_LT(undercut(before), 0.005);
  EXPECT_GT(undercut(after), 0.05);
  const auto little = overhang(coast.site, {{"amplitude", 0.5}});
  EXPECT_LT(undercut(test::carved(coast.site, little)), 0.5 * undercut(after));
}

TEST(Overhang, TheRockStaysInOnePiece) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Coast coast;
    coast.site.seed = seed;
    const auto after = test::carved(coast.site, overhang(coast.site));
    std::size_t most = 0, all = 0;
    for (const test::Piece& piece : test::pieces(after, {{-60, -45, -12}, {60, 45, 45}}, 1, true)) {
      most = std::max(most, piece.cells);
      all += piece.cells;
    }
    EXPECT_GT(ratio(most, all), 0.999);
  }
}

TEST(Overhang, LevelGroundStays) {
  const Coast flat([](Vec3d) { return 0.5; }, [](double x, double) { return 0.05 * x; });
  EXPECT_FALSE(overhang(flat.site).reshape);
  const Coast coast;
  const auto before = field::compile(coast.site.terrain),
             after = test::carved(coast.site, overhang(coast.site));
  for (const Vec3d p : test::places({{-55, 35, 25}, {55, 44, 35}}, 2000, 1))
    EXPECT_EQ(before.value(p), after.value(p));
}

}  // namespace
}  // namespace tafoni::landforms
