#include "tafoni/scene/build/impl/base.h"

#include <cmath>
#include <fstream>
#include <numbers>

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/heard_warnings.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/scene/session.h"

namespace tafoni::scene {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Flat ground at 0, 80 m by 60 m, with strokes.
class Flat : public ::testing::Test {
 protected:
  Document scene(const std::string& strokes, const std::string& more = "") {
    std::ofstream(folder.path / "a.strokes") << strokes;
    return parse_scene(
        "[scene]\nvoxel = 1\nmin_fragment = 0\n[terrain]\ngenerator = \"plane\"\nwidth = 80\nheight = 60\n"
        "pixel = 1\nroughness = 0\ninfluence = 6\namplitude = 3\n" +
            more + "[[layer]]\ntype = \"sculpt\"\nname = \"dig\"\nstrokes = \"a.strokes\"\n",
        folder.path / "s.toml");
  }
  double base(const std::string& strokes) {
    const BuiltScene s = build(scene(strokes), warnings);
    return s.terrain.to_world(s.terrain.box.lo).z;
  }
  static mesh::MeshMetrics metrics(const Document& document) {
    return mesh::metrics(mesh_scene(build(document)).mesh);
  }

  const TestFolder folder;
  HeardWarnings warnings;
};

TEST_F(Flat, TheBaseLiesUnderWhatIsCarved) {
  const double own = base("");
  EXPECT_LE(own, -6);
  EXPECT_GE(own, -9);
  // The ball's floor is at -45, and R of rock is left below it.
  const double below = base("sphere at=40,30,-40 radius=5 roughness=0\n");
  EXPECT_LE(below, -45 - 6);
  EXPECT_GE(below, -45 - 6 - 3);
  EXPECT_THAT(warnings.said, IsEmpty());
}

TEST_F(Flat, WhatStaysAboveTheBaseLeavesIt) {
  const double own = base("");
  EXPECT_EQ(base("sphere at=40,30,0 radius=3 roughness=0\n"), own);
  // Its support reaches below the base, but its surface does not.
  EXPECT_EQ(base("sphere at=40,30,-2.5 radius=4 roughness=0\n"), own);
  // Rock within rock moves no surface, nor does what is beside the terrain.
  EXPECT_EQ(base("sphere at=40,30,-30 radius=4 mode=add\n"), own);
  EXPECT_EQ(base("sphere at=140,30,-30 radius=4\n"), own);
}

TEST_F(Flat, ACaveBelowTheBaseIsInTheMesh) {
  const mesh::MeshMetrics whole = metrics(scene(""));
  const mesh::MeshMetrics hollow = metrics(scene("sphere at=40,30,-40 radius=5 roughness=0\n"));
  EXPECT_TRUE(hollow.closed);
  EXPECT_EQ(hollow.components, 2u);
  const double deeper =
      (whole.bounds.lo.z - hollow.bounds.lo.z) * whole.bounds.size().x * whole.bounds.size().y;
  const double ball = 4.0 / 3 * std::numbers::pi * 125;
  EXPECT_NEAR(hollow.volume, whole.volume + deeper - ball, 0.3 * ball);
  // A shaft from the ground to it: one surface, and no rock straight up from its foot.
  const Document shaft = scene("curve at=40,30,5/40,30,-40 radius=5 roughness=0\n");
  EXPECT_EQ(metrics(shaft).components, 1u);
  const BuiltScene s = build(shaft);
  const auto field = s.field_for(surface::Boundary::solid);
  for (double z = -40; z < 40; z += 0.5) EXPECT_LT(field.value(s.terrain.to_local({40, 30, z})), 0) << z;
}

TEST_F(Flat, WhatIsTooDeepToFollowIsTold) {
  base(fmt::format("sphere at=40,30,{} radius=5\n", -impl::deepest_base - 500));
  base(fmt::format("curve at=40,30,0/40,30,{} radius=5\n", -impl::deepest_base - 500));
  const auto told = HasSubstr("5000 m below the terrain is cut off");
  EXPECT_THAT(warnings.said, ElementsAre(told, told));
}

TEST_F(Flat, WhatASessionMeshesIsWhatABuildDoes) {
  Document document = scene("sphere at=40,30,0 radius=4\n");
  save_scene(document, folder.path / "s.toml");
  Session session = Session::open(folder.path / "s.toml");
  session.mesh();
  for (const char* stroke :
       {"sphere at=20,30,-20 radius=4", "sphere at=60,30,-50 radius=4", "sphere at=40,20,-20 radius=3"}) {
    session.stroke(0, parse_stroke(stroke, "test"));
    session.update();
    const mesh::Mesh mesh = session.mesh().mesh, fresh = mesh_scene(build(session.document())).mesh;
    EXPECT_TRUE(mesh.positions == fresh.positions && mesh.triangles == fresh.triangles) << stroke;
  }
  session.undo(0, 2);
  session.update();
  const mesh::Mesh mesh = session.mesh().mesh, fresh = mesh_scene(build(session.document())).mesh;
  EXPECT_TRUE(mesh.positions == fresh.positions && mesh.triangles == fresh.triangles);
}

TEST_F(Flat, StrokesBesideTheTerrainAreToldAndNoneStopsTheBuild) {
  const std::string good = "sphere at=40,30,0 radius=4 roughness=0\n";
  const BuiltScene s =
      build(scene(good + "sphere at=400,30,0\nsphere at=6000000,30,0 radius=4\npaint at=0,500,0 radius=9\n"),
            warnings);
  EXPECT_THAT(warnings.said,
              ElementsAre("layer dig: 3 of 4 strokes (\"sphere at=400,30,0\" …) lie outside of the "
                          "terrain (x 0 to 80, y 0 to 60) and change nothing; check their positions"));
  const BuiltScene alone = build(scene(good));
  const auto mesh = mesh_scene(s).mesh, expected = mesh_scene(alone).mesh;
  EXPECT_TRUE(mesh.positions == expected.positions && mesh.triangles == expected.triangles);
}

TEST_F(Flat, StrokesThatCarveAirAreTold) {
  build(scene("sphere at=40,30,0 radius=4\nsphere at=40,30,90 radius=4\nsphere at=40,30,300 radius=4\n"),
        warnings);
  EXPECT_THAT(
      warnings.said,
      ElementsAre("layer dig: 2 of 3 strokes that carve (\"sphere at=40,30,90 radius=4.0\" …) meet nothing "
                  "but air, above all rock, and change nothing; check their heights"));
  warnings.said.clear();
  build(scene("sphere at=40,30,90 radius=8 mode=add\nsphere at=40,30,90 radius=4\n"), warnings);
  EXPECT_THAT(warnings.said, ElementsAre());
}

TEST_F(Flat, AStrokeThatDoesNothingIsNotStored) {
  save_scene(scene("sphere at=40,30,0\n"), folder.path / "s.toml");
  Session session = Session::open(folder.path / "s.toml");
  for (const char* stroke : {"sphere at=6000000,6000000,20", "sphere at=90,30,0", "sphere at=40,30,-9000",
                             "sphere at=40,30,9000", "paint at=-50,30,0", "curve at=40,30,0/40,30,200000"}) {
    try {
      session.stroke(0, parse_stroke(stroke, "test"));
      ADD_FAILURE() << stroke;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_THAT(error.what(), HasSubstr(stroke));
      EXPECT_THAT(error.what(), HasSubstr("lies outside of the terrain (x 0 to 80, y 0 to 60)"));
    }
  }
  EXPECT_EQ(session.strokes(0).size(), 1u);
  session.stroke(0, parse_stroke("sphere at=83,30,0 radius=5", "test"));
  EXPECT_EQ(session.strokes(0).size(), 2u);
}

TEST_F(Flat, AStrokeThatCannotBeMadeIsNamed) {
  try {
    build(scene("sphere at=40,30,0\nskeletal at=30,30,0 kind=curve\n"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("layer dig: the stroke \"skeletal at=30,30,0 kind=curve\": "));
  }
}

TEST_F(Flat, PrimitivesPointsAndRegionsBesideTheTerrainAreTold) {
  std::ofstream(folder.path / "p.csv")
      << "kind,x,y,z,radius,energy\npoint,40,30,0,6,-3\npoint,400,30,0,6,-3\n"
         "sphere,40,300,0,6,-3\n";
  std::ofstream(folder.path / "s.csv") << "x,y,z\n40,30,0\n400,30,0\n";
  std::ofstream(folder.path / "far.geojson")
      << R"({"type": "Polygon", "coordinates": [[[500, 0], [580, 0], [580, 120], [500, 120], [500, 0]]]})";
  Document d = scene("", "");
  const auto warnings_of = [&](const std::string& layer) {
    HeardWarnings heard;
    build(parse_scene("[scene]\nvoxel = 1\n[terrain]\ngenerator = \"plane\"\nwidth = 80\nheight = 60\n"
                      "pixel = 1\n[[layer]]\n" +
                          layer,
                      folder.path / "t.toml"),
          heard);
    return heard.said;
  };
  EXPECT_THAT(warnings_of("type = \"primitives\"\nfile = \"p.csv\"\n"),
              ElementsAre(HasSubstr("2 of 3 primitives lie outside of the terrain (x 0 to 80, y 0 to 60)")));
  EXPECT_THAT(warnings_of("type = \"hoodoos\"\npoints = \"s.csv\"\n"),
              testing::Contains(HasSubstr("s.csv: 1 of 2 points lie outside of the terrain")));
  EXPECT_THAT(warnings_of("type = \"primitives\"\nfile = \"p.csv\"\nregion = \"far.geojson\"\n"),
              testing::Contains(HasSubstr("layer primitives: its region lies outside of the terrain")));
}

}  // namespace
}  // namespace tafoni::scene
