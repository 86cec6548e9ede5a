#include "tafoni/scene/products/cut.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/heard_warnings.h"
#include "tafoni/render/inner/palette.h"

namespace tafoni::scene {
namespace {

/// 60 x 40 m: 20 m in the west, a face of 45 degrees about x = 30, 0 m in the east.
Document block(std::string_view more = "") {
  return parse_scene(
      std::string("[scene]\nvoxel = 1.0\n[terrain]\ngenerator = \"cliff\"\nwidth = 60\nheight = 40\n"
                  "pixel = 1.0\nelevation = 20\nshelf = 0\nplace = 0.5\nslope = 45\nbends = 0\n"
                  "roughness = 0\n") +
          std::string(more),
      std::filesystem::path(testing::TempDir()) / "s.toml");
}

/// Area of the triangles that lie in the plane `at` + anything along `along` and up.
double area_in(const mesh::Mesh& mesh, Vec2d at, Vec2d along) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[t[0]]), b = to_double(mesh.positions[t[1]]),
                c = to_double(mesh.positions[t[2]]);
    const auto off = [&](Vec3d p) {
      return std::abs(along.x * (p.y + mesh.origin.y - at.y) - along.y * (p.x + mesh.origin.x - at.x));
    };
    if (std::max({off(a), off(b), off(c)}) < 1e-4) sum += 0.5 * length(cross(b - a, c - a));
  }
  return sum;
}

TEST(Cut, WallsFillWhatIsSolidDownToTheBase) {
  const BuiltScene scene = build(block());
  const mesh::Mesh mesh = cut_mesh(scene, middle_cut(scene));
  const double base = scene.terrain.to_world(scene.terrain.box.lo).z;
  // The mean height is 10 m; its edges are rounded alike above and below.
  EXPECT_NEAR(area_in(mesh, {0, 20}, {1, 0}), 60 * (10 - base), 2);
  EXPECT_NEAR(area_in(mesh, {0, 40}, {1, 0}), 60 * (10 - base), 2);
  EXPECT_NEAR(area_in(mesh, {0, 20}, {0, 1}), 20 * (20 - base), 2);
  EXPECT_NEAR(area_in(mesh, {60, 20}, {0, 1}), 20 * (0 - base), 2);
  for (const Vec3f& p : mesh.positions) EXPECT_GE(p.y + mesh.origin.y, 20 - 1e-4);
}

TEST(Cut, KeepsTheLeftOfAnyLine) {
  const BuiltScene scene = build(block());
  const mesh::Mesh mesh = cut_mesh(scene, {{20, 0}, {40, 40}});
  const Vec2d along{1 / std::sqrt(5.0), 2 / std::sqrt(5.0)};
  for (const Vec3f& p : mesh.positions)
    EXPECT_GE(along.x * (p.y + mesh.origin.y) - along.y * (p.x + mesh.origin.x - 20), -1e-4);
  const double base = scene.terrain.to_world(scene.terrain.box.lo).z;
  EXPECT_NEAR(area_in(mesh, {20, 0}, along), std::sqrt(2000.0) * (10 - base), 3);
}

TEST(Cut, AirBelowGroundStaysOpen) {
  const auto csv =
      std::filesystem::path(testing::TempDir()) / ("cut_hole_" + std::to_string(::getpid()) + ".csv");
  std::ofstream(csv) << "kind,x,y,z,radius,energy\npoint,12,20,8,8,-30\n";
  const BuiltScene whole = build(block());
  const BuiltScene holed =
      build(block("[[layer]]\ntype = \"primitives\"\nfile = \"" + csv.filename().string() + "\"\n"));
  const double missing = area_in(cut_mesh(whole, middle_cut(whole)), {0, 20}, {1, 0}) -
                         area_in(cut_mesh(holed, middle_cut(holed)), {0, 20}, {1, 0});
  // f = -30 g(d / 8) plus at most T: a disk of some radius below 8 m.
  EXPECT_GT(missing, 60);
  EXPECT_LT(missing, 201);
  std::filesystem::remove(csv);
}

TEST(Cut, IsColouredByResistance) {
  const BuiltScene scene =
      build(block("[[geology]]\ntype = \"strata\"\nthickness = [5]\nhardness = [0.9, 0.1]\n"));
  const mesh::Mesh mesh = cut_mesh(scene, middle_cut(scene));
  ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); i += 97)
    EXPECT_EQ(mesh.colors[i], render::to_rgba8(resistance_ramp(static_cast<float>(
                                  scene.geology->resistance(to_double(mesh.positions[i]))))));
  float last = -1;
  for (float rho = 0; rho <= 1; rho += 0.05f) {
    const Vec3f c = resistance_ramp(rho);
    EXPECT_GT(c.x + c.y + c.z, last) << "the ramp must grow paler";
    last = c.x + c.y + c.z;
  }
}

TEST(Cut, RefusesLinesThatLeaveNothing) {
  const BuiltScene scene = build(block());
  EXPECT_EQ(error_of([&] {
              cut_mesh(scene, {{5, 5}, {5, 5}});
            }),
            "The line of the cut has no length; give two places on the map.");
  EXPECT_THAT(
      error_of([&] {
        cut_mesh(scene, {{0, 90}, {60, 90}});
      }),
      ::testing::StartsWith("Nothing of the terrain lies to the left of the cut; swap its ends or move it"));
  HeardWarnings heard;
  cut_mesh(scene, {{60, 90}, {0, 90}}, heard);
  EXPECT_THAT(heard.said, ::testing::ElementsAre(::testing::StartsWith("the cut passes beside the terrain")));
  cut_mesh(scene, middle_cut(scene), heard);
  EXPECT_EQ(heard.said.size(), 1u);
}

}  // namespace
}  // namespace tafoni::scene
