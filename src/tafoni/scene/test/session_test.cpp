#include "tafoni/scene/session.h"

#include <chrono>
#include <fstream>

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/rounds.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/csv.h"
#include "tafoni/scene/layers/layer.h"
#include "tafoni/scene/sculpt/impl/sculpt.h"

namespace tafoni::scene {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::string_view bare_ground =
    "# a scene of mine\n[scene]\nvoxel = 2   # coarse\nseed = 5\nmin_fragment = 50\n"
    "[terrain]\ngenerator = \"coast\"\nwidth = 32\nheight = 24\npixel = 2\n\n";

class SessionScene : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, std::string_view text) {
    std::ofstream(root / name) << text;
    return root / name;
  }
  template <class F>
  static std::string failure(F&& f) {
    try {
      f();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  const TestFolder folder;
  const fs::path root = folder.path;
};

bool same_whole_mesh(const mesh::Mesh& a, const mesh::Mesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.triangles == b.triangles &&
         a.colors == b.colors && a.origin == b.origin;
}

Stroke random_stroke(Random& random) {
  Stroke s;
  const char* brushes[] = {"sphere", "sphere", "curve", "cave", "skeletal", "arch", "paint"};
  s.brush = brushes[random.below(7)];
  const auto somewhere = [&] {
    return Vec3d{random.uniform(5, 60), random.uniform(5, 44), random.uniform(-5, 40)};
  };
  s.points = {somewhere()};
  if (s.brush == "curve" || s.brush == "arch" || s.brush == "cave")
    s.points.push_back(s.points[0] +
                       Vec3d{random.uniform(-12, 12), random.uniform(2, 12), random.uniform(-3, 3)});
  s.mode = random.below(3) == 0 ? "add" : "carve";
  s.radius = random.uniform(1.5, 6);
  s.seed = static_cast<std::int64_t>(random.below(5));
  if (s.brush == "arch") s.values = {{"depth", 8.0}, {"height", 6.0}};
  if (s.brush == "paint") s.radius = 15;
  if (s.brush == "paint" && random.below(3) == 0) s.values["erase"] = true;
  return s;
}

void random_change(Session& session, Random& random) {
  const auto layers = session.document().layers.size();
  const auto index = random.below(layers);
  const bool sculpts = find_layer_type(session.document().layers[index].type).takes_strokes;
  switch (random.below(14)) {
    case 0:
      return session.mute_layer(index, session.document().layers[index].settings.enabled);
    case 1:
      return session.move_layer(index, random.below(layers));
    case 2:
      return session.reseed_layer(index, static_cast<std::int64_t>(random.below(4)) - 1);
    case 3:
      return session.set(fmt::format("sea-cliff.range={}", 3 + random.below(4)));
    case 4:
      return session.set(fmt::format("planes.strength={}", 0.1 * static_cast<double>(random.below(3))));
    case 5:
      if (random.below(6) == 0) return session.set(fmt::format("terrain.amplitude={}", 7 + random.below(2)));
      return session.set(fmt::format("balls.enabled={}", random.below(2) ? "true" : "false"));
    case 6: {
      if (!sculpts) return;
      const auto strokes = session.strokes(index);
      if (strokes.empty()) return;
      const auto& one = strokes[random.below(strokes.size())];
      if (one.id > 0) session.mute_stroke(index, one.id, !one.muted);
      return;
    }
    case 7:
    case 8:
      if (sculpts) session.undo(index, 1 + random.below(3));
      return;
    case 9:
      if (sculpts) session.redo(index, 1 + random.below(3));
      return;
    default:
      if (sculpts) session.stroke(index, random_stroke(random));
  }
}

TEST_F(SessionScene, AnyHistoryBuildsAndMeshesAsAFreshBuildDoes) {
  write("p.csv", "kind,x,y,z,radius,energy\npoint,40,30,20,6,-3\nsphere,60,30,20,4,9\n");
  write("first.strokes", "sphere at=30,30,15 radius=5\n");
  const fs::path file =
      write("s.toml", std::string(bare_ground) +
                          "[[geology]]\ntype = \"planes\"\n"
                          "[[layer]]\ntype = \"sculpt\"\nname = \"low\"\nstrokes = \"first.strokes\"\n"
                          "[[layer]]\ntype = \"primitives\"\nname = \"balls\"\nfile = \"p.csv\"\n"
                          "mask = \"paint:region\"\n"
                          "[[layer]]\ntype = \"sea-cliff\"\nrange = 4\n"
                          "[[layer]]\ntype = \"sculpt\"\nname = \"high\"\n");
  Session session = Session::open(file);
  Random random(2026);
  int meshed_less = 0;
  const int steps = rounds(200);
  for (int step = 0; step < steps; ++step) {
    random_change(session, random);
    session.update();
    const MeshResult incremental = session.mesh();
    const BuiltScene fresh = build(session.document());
    ASSERT_TRUE(same_whole_mesh(incremental.mesh, mesh_scene(fresh).mesh)) << "at step " << step;
    meshed_less += session.mesher().stats().chunks < session.mesher().chunks().size();
  }
  EXPECT_GT(meshed_less, steps / 10);
  session.save();
  EXPECT_TRUE(same_whole_mesh(session.mesh().mesh, mesh_scene(build(load_scene(file))).mesh));
  EXPECT_THAT(io::read_text(file), HasSubstr("voxel = 2   # coarse"));
}

TEST_F(SessionScene, RunsOnlyWhatChangedAndWhatComesAfter) {
  const fs::path file = write("s.toml", std::string(bare_ground) +
                                            "[[layer]]\ntype = \"sea-cliff\"\nname = \"a\"\n"
                                            "[[layer]]\ntype = \"sea-cliff\"\nname = \"b\"\n"
                                            "[[layer]]\ntype = \"sea-cliff\"\nname = \"c\"\n");
  Session session = Session::open(file);
  EXPECT_THAT(session.update().rerun, ElementsAre("a", "b", "c"));
  const Update same = session.update();
  EXPECT_THAT(same.rerun, IsEmpty());
  EXPECT_THAT(same.changed, IsEmpty());
  session.set("b.range=5");
  EXPECT_THAT(session.update().rerun, ElementsAre("b", "c"));
  session.mute_layer(1, true);
  EXPECT_THAT(session.update().rerun, ElementsAre("c"));
  session.mute_layer(1, false);
  EXPECT_THAT(session.update().rerun, IsEmpty());
  session.set("scene.min_fragment=7");
  EXPECT_THAT(session.update().rerun, IsEmpty());
  session.set("terrain.amplitude=8");
  EXPECT_THAT(session.update().rerun, ElementsAre("a", "b", "c"));
}

TEST_F(SessionScene, AFileThatChangesRunsItsLayerAgain) {
  const std::string head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 80\n";
  write("p.csv", "kind,x,y,z,radius,energy\npoint,40,30,20,6,-3\npoint,60,30,20,6,-3\n");
  write("m.asc", head + "1 1\n1 1\n");
  const fs::path file =
      write("s.toml", std::string(bare_ground) +
                          "[[layer]]\ntype = \"primitives\"\nfile = \"p.csv\"\nmask = \"m.asc\"\n");
  Session session = Session::open(file);
  const auto count = [&] {
    return field::stats(session.update().scene->layers.at(0).made.nodes.at(0)).primitives;
  };
  EXPECT_EQ(count(), 2u);
  // The same length and perhaps the same time: what it holds must decide.
  write("p.csv", "kind,x,y,z,radius,energy\npoint,40,30,20,6,-3\npoint,60,30,20,7,-3\n");
  EXPECT_THAT(session.update().rerun, ElementsAre("primitives"));
  write("m.asc", head + "0 0\n0 0\n");
  EXPECT_THAT(session.update().scene->layers.at(0).made.nodes, IsEmpty());
  write("m.asc", head + "1 1\n1 1\n");
  EXPECT_EQ(count(), 2u);
}

TEST_F(SessionScene, PaintLimitsALayer) {
  write("p.csv", "kind,x,y,z,radius,energy\npoint,20,30,20,6,-3\npoint,60,30,20,6,-3\n");
  const fs::path file =
      write("s.toml", std::string(bare_ground) +
                          "[[layer]]\ntype = \"primitives\"\nfile = \"p.csv\"\nmask = \"paint:here\"\n"
                          "[[layer]]\ntype = \"sculpt\"\n");
  Session session = Session::open(file);
  const auto count = [&] {
    const auto& nodes = session.update().scene->layers.at(0).made.nodes;
    return nodes.empty() ? 0 : field::stats(nodes[0]).primitives;
  };
  EXPECT_EQ(count(), 0u);
  session.stroke(1, parse_stroke("paint at=60,30,0 radius=10 mask=here", "test"));
  EXPECT_EQ(count(), 1u);
  session.stroke(1, parse_stroke("paint at=20,30,0/60,30,0 radius=10 mask=here", "test"));
  EXPECT_EQ(count(), 2u);
  session.stroke(1, parse_stroke("paint at=20,30,0 radius=10 mask=here erase=true", "test"));
  EXPECT_EQ(count(), 1u);
  session.stroke(1, parse_stroke("paint at=60,30,0 radius=10 mask=other erase=true", "test"));
  EXPECT_EQ(count(), 1u);
  session.undo(1, 2);
  EXPECT_EQ(count(), 2u);
}

TEST_F(SessionScene, StrokesSurviveARestartAndTheSceneKeepsItsComments) {
  const fs::path file = write("s.toml", bare_ground);
  {
    Session session = Session::open(file);
    const std::size_t layer = session.sculpt_layer("dig");
    session.stroke(layer, parse_stroke("sphere at=40,30,10", "test"));
    session.stroke(layer, parse_stroke("sphere at=50,30,10", "test"));
    session.undo(layer);
  }
  EXPECT_THAT(io::read_text(file), HasSubstr("# a scene of mine"));
  EXPECT_THAT(io::read_text(file), HasSubstr("voxel = 2   # coarse"));
  EXPECT_THAT(io::read_text(file), HasSubstr("journal = \"s.dig.journal\""));
  Session session = Session::open(file);
  const std::size_t layer = session.sculpt_layer("dig");
  EXPECT_EQ(session.strokes(layer).size(), 1u);
  EXPECT_EQ(session.redoable(layer), 1u);
  EXPECT_EQ(session.redo(layer), 1u);
  EXPECT_EQ(session.strokes(layer).size(), 2u);
  EXPECT_THAT(failure([&] { session.undo(7); }), HasSubstr("takes no strokes"));
}

TEST_F(SessionScene, AWrongStrokeIsNotStored) {
  const fs::path file = write("s.toml", bare_ground);
  Session session = Session::open(file);
  const std::size_t layer = session.sculpt_layer();
  Stroke stroke;
  stroke.brush = "arch";
  stroke.points = {{40, 30, 10}, {40, 30, 10}};
  EXPECT_THAT(failure([&] { session.stroke(layer, stroke); }), HasSubstr("the feet stand on one another"));
  EXPECT_TRUE(session.strokes(layer).empty());
  EXPECT_FALSE(fs::exists(root / "s.sculpt.journal"));
}

TEST_F(SessionScene, WhatComesLastWins) {
  write("a.strokes", "sphere at=40,30,-8 radius=6 roughness=0\n");
  write("b.strokes",
        "sphere at=40,30,-8 radius=6 roughness=0\nsphere at=41,30,-8 radius=6 roughness=0\n"
        "sphere at=40,31,-8 radius=6 roughness=0\nsphere at=40,30,-8 radius=9 roughness=0 mode=add\n");
  const auto value = [&](const std::string& strokes, Vec3d at) {
    const BuiltScene s = build(load_scene(
        write("s.toml", std::string(bare_ground) + "depth = 40\n[[layer]]\ntype = \"sculpt\"\nstrokes = \"" +
                            strokes + "\"\n")));
    return s.field_for(surface::Boundary::open).value(s.terrain.to_local(at));
  };
  EXPECT_LT(value("a.strokes", {40, 30, -8}), 0);
  EXPECT_GT(value("b.strokes", {40, 30, -8}), 0);
  // The surface lies at the radius.
  EXPECT_LT(value("a.strokes", {40, 30, -13.8}), 0);
  EXPECT_GT(value("a.strokes", {40, 30, -14.2}), 0);
}

TEST(SculptCook, ThousandsOfStrokesStayFast) {
  Random random(1);
  std::vector<impl::Slot> slots;
  const auto stroke = [&] {
    auto s = std::make_shared<Stroke>();
    s->brush = "sphere";
    s->points = {{random.uniform(0, 500), random.uniform(0, 500), random.uniform(0, 50)}};
    return impl::Slot{std::move(s), false};
  };
  for (int i = 0; i < 5000; ++i) slots.push_back(stroke());
  impl::SculptCook cook;
  impl::SculptFrame frame;
  auto before = cook.cook(slots, frame).value;
  const auto cooked = cook.groups_cooked();
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 20; ++i) {
    slots.push_back(stroke());
    auto now = cook.cook(slots, frame).value;
    std::vector<Box3d> boxes;
    changed_boxes(before.get(), now.get(), boxes);
    ASSERT_EQ(boxes.size(), 1u);
    EXPECT_TRUE(boxes[0].contains(slots.back().stroke->points[0]));
    before = std::move(now);
  }
  const double each = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / 20;
  EXPECT_EQ(cook.groups_cooked() - cooked, 20u);
  EXPECT_EQ(cook.strokes_cooked(), 5020u);
  RecordProperty("milliseconds_a_stroke", std::to_string(1e3 * each));
  EXPECT_LT(each, 0.1);
}

}  // namespace
}  // namespace tafoni::scene
