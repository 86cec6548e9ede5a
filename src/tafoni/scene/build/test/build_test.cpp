#include "tafoni/scene/build/build.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/field/primitive.h"
#include "tafoni/io/image_file.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/scene/products/mesh_scene.h"

namespace tafoni::scene {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A folder of scene files that is removed afterwards.
class BuildScene : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) { std::ofstream(root / name) << text; }
  Document scene(const std::string& layers) {
    return parse_scene(
        "[scene]\nvoxel = 2\nseed = 5\n[terrain]\ngenerator = \"coast\"\nwidth = 80\nheight = 60\n"
        "pixel = 2\n" +
            layers,
        root / "s.toml");
  }
  std::string failure(const Document& document) {
    try {
      build(document);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  const TestFolder folder;
  const fs::path root = folder.path;
};

bool same_mesh(const mesh::Mesh& a, const mesh::Mesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.triangles == b.triangles &&
         a.colors == b.colors;
}

/// Values of f - (f without layers) at random places.
std::vector<double> added(const BuiltScene& scene, const BuiltScene& bare) {
  const auto with = scene.field_for(surface::Boundary::open),
             without = bare.field_for(surface::Boundary::open);
  Random random(3);
  std::vector<double> out;
  for (int i = 0; i < 3000; ++i) {
    const Box3d& box = scene.terrain.box;
    const Vec3d p{random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                  random.uniform(box.lo.z, box.hi.z)};
    out.push_back(static_cast<double>(with.value(p)) - static_cast<double>(without.value(p)));
  }
  return out;
}

TEST_F(BuildScene, SameBytesAtAnyThreadCount) {
  const Document d = scene("[[layer]]\ntype = \"sea-cliff\"\n[[layer]]\ntype = \"karst\"\n");
  set_thread_count(1);
  const MeshResult one = mesh_scene(build(d));
  set_thread_count(3);
  const MeshResult many = mesh_scene(build(d));
  set_thread_count(0);
  EXPECT_GT(one.mesh.triangles.size(), 10000u);
  EXPECT_TRUE(same_mesh(one.mesh, many.mesh));
  const mesh::MeshReport report = mesh::validate(one.mesh);
  EXPECT_TRUE(report.valid());
  EXPECT_TRUE(report.closed());
}

TEST_F(BuildScene, AReadmeLongSceneSurvivesSavingAndBuildsTheSame) {
  const Document d = scene(
      "[[geology]]\ntype = \"planes\"\n[[geology]]\ntype = \"turbulence\"\n"
      "[[layer]]\ntype = \"sea-cliff\"\nrange = 5\nseed = 11\n");
  fs::create_directories(root / "elsewhere");
  save_scene(d, root / "elsewhere" / "t.toml");
  EXPECT_TRUE(same_mesh(mesh_scene(build(d)).mesh,
                        mesh_scene(build(load_scene(root / "elsewhere" / "t.toml"))).mesh));
}

TEST_F(BuildScene, PrimitivesAddTheirEnergyWhereTheLayerActs) {
  write("p.csv", "kind,x,y,z,radius,energy\npoint,40,60,20,6,-3\nsphere,120,60,20,4,2\n");
  const BuiltScene bare = build(scene(""));
  const auto value = [&](const std::string& limits, Vec3d world) {
    const BuiltScene s = build(scene("[[layer]]\ntype = \"primitives\"\nfile = \"p.csv\"\n" + limits));
    const Vec3d p = s.terrain.to_local(world);
    return s.field_for(surface::Boundary::open).value(p) - bare.field_for(surface::Boundary::open).value(p);
  };
  const Vec3d at_point{40, 60, 20}, at_sphere{120, 60, 23};
  EXPECT_NEAR(value("", at_point), -3, 1e-3);
  EXPECT_NEAR(value("", at_sphere), 2, 1e-3);
  EXPECT_NEAR(value("", {120, 60, 20 + 4 + 7.5}), 2 * std::pow(1 - 0.25, 3), 1e-3);
  EXPECT_EQ(value("enabled = false\n", at_point), 0);
  EXPECT_EQ(value("box = [100, 0, -100, 200, 200, 100]\n", at_point), 0);
  EXPECT_NEAR(value("box = [100, 0, -100, 200, 200, 100]\n", at_sphere), 2, 1e-3);
  EXPECT_EQ(value("altitude = [30, 50]\n", at_point), 0);
  write("left.geojson",
        R"({"type": "Polygon", "coordinates": [[[0, 0], [80, 0], [80, 120], [0, 120], [0, 0]]]})");
  EXPECT_NEAR(value("region = \"left.geojson\"\n", at_point), -3, 1e-3);
  EXPECT_EQ(value("region = \"left.geojson\"\n", at_sphere), 0);
}

TEST_F(BuildScene, EveryKindOfPrimitiveStandsWhereItsRowSays) {
  std::string csv = "id,kind,x,y,z,energy,radius\n";
  double x = 20;
  std::vector<Vec3d> inside;
  for (const field::PrimitiveType* type : field::all_primitives()) {
    csv += fmt::format("a,{},{},60,20,-3,1\n", type->about.name, x);
    if (type->variable) csv += fmt::format("a,{},{},80,20,-3,\n", type->about.name, x);
    // A torus is hollow in the middle: its tube runs 10 m off.
    inside.push_back({x, type->about.name == "torus" ? 70.0 : 60.0, 20});
    x += 60;
  }
  write("k.csv", csv);
  const std::string layer = "[[layer]]\ntype = \"primitives\"\nfile = \"k.csv\"\nfalloff = 2\n";
  const BuiltScene plain = build(scene(layer)), noisy = build(scene(layer + "noise = 0.5\n"));
  const auto value = [](const BuiltScene& s, Vec3d local) {
    return field::compile(field::blend(s.layers[0].made.nodes)).value(local);
  };
  for (const Vec3d& p : inside) EXPECT_NEAR(value(plain, plain.terrain.to_local(p)), -3, 1e-3) << p.x;
  const Vec3d wall = plain.terrain.to_local({20, 60, 20 + 6.5});
  EXPECT_NE(value(plain, wall), value(noisy, wall));
  EXPECT_THAT(failure(scene(layer + "noise = 1.5\n")), HasSubstr("layer primitives: "));
  EXPECT_THAT(failure(scene(layer + "noise = 1.5\n")), HasSubstr("k.csv:2: "));
}

TEST_F(BuildScene, AMaskLimitsALayer) {
  write("p.csv", "kind,x,y,z,radius,energy\npoint,40,60,20,6,-3\npoint,120,60,20,6,-3\n");
  std::string rows;
  for (int row = 0; row < 4; ++row) rows += "1 1 0 0\n";
  write("m.asc", "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 40\n" + rows);
  const BuiltScene s = build(scene("[[layer]]\ntype = \"primitives\"\nfile = \"p.csv\"\nmask = \"m.asc\"\n"));
  ASSERT_EQ(s.layers.size(), 1u);
  EXPECT_EQ(field::stats(s.layers[0].made.nodes.at(0)).primitives, 1u);
}

// The terrain is 160 x 120 m; the western half of the picture is white.
TEST_F(BuildScene, APaintedMaskWithoutAPlaceLiesOverTheTerrain) {
  write("p.csv", "kind,x,y,z,radius,energy\npoint,40,60,20,6,-3\npoint,120,60,20,6,-3\n");
  using Colour = std::array<std::uint8_t, 4>;
  const auto paint = [&](const std::string& name, int width, int height) {
    raster::Image image(width, height);
    for (int row = 0; row < height; ++row)
      for (int col = 0; col < width; ++col)
        image.at(col, row) = col < width / 2 ? Colour{255, 255, 255, 255} : Colour{0, 0, 0, 255};
    io::write_image(root / name, image);
  };
  paint("half.png", 40, 30);
  paint("square.png", 30, 30);
  const std::string layer = "[[layer]]\ntype = \"primitives\"\nfile = \"p.csv\"\nmask = ";
  const BuiltScene s = build(scene(layer + "\"half.png\"\n"));
  ASSERT_EQ(s.layers.size(), 1u);
  EXPECT_EQ(field::stats(s.layers[0].made.nodes.at(0)).primitives, 1u);
  EXPECT_THAT(failure(scene(layer + "\"square.png\"\n")),
              HasSubstr("its 30 x 30 pixels are no picture of the terrain, which is 160 by 120 m"));
}

TEST_F(BuildScene, SeedsDecideAndLayersDoNotDisturbOneAnother) {
  const std::string cliff = "[[layer]]\ntype = \"sea-cliff\"\n";
  const BuiltScene bare = build(scene(""));
  const auto once = added(build(scene(cliff)), bare);
  EXPECT_EQ(once, added(build(scene(cliff)), bare));
  EXPECT_EQ(once, added(build(scene(cliff + "[[layer]]\ntype = \"karst\"\nenabled = false\n")), bare));
  EXPECT_NE(once, added(build(scene(cliff + "seed = 99\n")), bare));
  EXPECT_GT(std::count_if(once.begin(), once.end(), [](double v) { return v != 0; }), 0);
}

TEST_F(BuildScene, SeedsFollowTheirLayers) {
  const std::string cliff = "[[layer]]\ntype = \"sea-cliff\"\n", karst = "[[layer]]\ntype = \"karst\"\n";
  const std::string named = karst + "name = \"deep\"\n";
  const auto seed = [&](const std::string& layers, std::size_t i) { return layer_seed(scene(layers), i); };
  EXPECT_EQ(seed(cliff + karst, 1), seed(karst + cliff, 0));
  EXPECT_EQ(seed(karst + named + karst, 2), seed(karst + karst, 1));
  EXPECT_EQ(seed(karst + "enabled = false\n" + karst, 1), seed(karst + karst, 1));
  EXPECT_EQ(seed(karst + "seed = 4\n" + karst, 0), 4u);
  EXPECT_NE(seed(karst + karst, 0), seed(karst + karst, 1));
  EXPECT_NE(seed(karst + named, 0), seed(karst + named, 1));
  EXPECT_NE(seed(cliff, 0), seed(karst, 0));
}

TEST_F(BuildScene, OpenAndSolidAgreeInsideTheDomain) {
  const BuiltScene s = build(scene("[[layer]]\ntype = \"sea-cliff\"\n"));
  const auto open = s.field_for(surface::Boundary::open), solid = s.field_for(surface::Boundary::solid);
  const Box3d box = s.terrain.box.grown(-s.settings.influence);
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p{random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                  random.uniform(box.lo.z, box.hi.z)};
    EXPECT_EQ(open.value(p), solid.value(p));
  }
}

TEST_F(BuildScene, ErrorsNameTheLayer) {
  EXPECT_THAT(failure(scene("[[layer]]\ntype = \"primitives\"\nname = \"balls\"\nfile = \"none.csv\"\n")),
              HasSubstr("layer balls: "));
  EXPECT_THAT(failure(scene("[[layer]]\ntype = \"karst\"\nregion = \"none.geojson\"\n")),
              HasSubstr("none.geojson"));
  EXPECT_THAT(failure(scene("[[layer]]\ntype = \"karst\"\npoints = \"none.csv\"\n")),
              HasSubstr("none.csv: does not exist"));
}

TEST_F(BuildScene, CancellingStopsIt) {
  Progress progress;
  progress.cancel();
  try {
    build(scene("[[layer]]\ntype = \"karst\"\n"), progress);
    FAIL() << "not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cancelled);
  }
}

TEST(DefaultVoxel, IsRoundAndBetweenPixelAndExtent) {
  const auto voxel = [](int width, int height, double pixel) {
    raster::Raster raster;
    raster.values = raster::Grid<float>(width, height);
    raster.placement.dx = raster.placement.dy = pixel;
    return default_voxel(raster, 15);
  };
  EXPECT_EQ(voxel(100, 100, 1), 1);
  EXPECT_EQ(voxel(1136, 726, 1), 1);
  EXPECT_EQ(voxel(80, 80, 10), 5);
  EXPECT_EQ(voxel(100, 100, 90), 50);
  for (double pixel = 0.01; pixel < 1000; pixel *= 1.07)
    for (const int width : {10, 100, 1000, 10000}) EXPECT_GE(3 * voxel(width, 10, pixel), pixel);
  EXPECT_EQ(voxel(512, 512, 10), 5);
  EXPECT_EQ(voxel(2350, 1800, 10), 20);
  EXPECT_EQ(voxel(256, 256, 0.01), 0.01);
}

TEST(DefaultVoxel, HeightsInAWrongUnitMakeNoHugeMesh) {
  // A heightmap of 16 bits whose units were taken for metres: a ridge of 65 km over 129 pixels of a metre.
  raster::Raster raster;
  raster.values = raster::Grid<float>(129, 129);
  double area = 0;
  for (int row = 0; row < 129; ++row)
    for (int col = 0; col < 129; ++col)
      raster.values.at(col, row) = static_cast<float>(65535 * std::pow(std::sin(0.2 * col), 2));
  for (int col = 0; col < 128; ++col)
    area += 128 * std::hypot(1, raster.values.at(col + 1, 0) - raster.values.at(col, 0));
  const double triangles = 2 * area / std::pow(default_voxel(raster, 15), 2);
  EXPECT_GT(2 * area, 1e8);
  EXPECT_LT(triangles, 2e7);
  // A cliff is no reason: the voxel is that of flat ground.
  for (float& v : raster.values.values()) v /= 1000;
  EXPECT_EQ(default_voxel(raster, 15), 1);
}

}  // namespace
}  // namespace tafoni::scene
