#include "tafoni/scene/products/volume_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include <gmock/gmock.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/heard_warnings.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/field/test/lattice.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/scene/build/impl/volume_heights.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/scene/session.h"

namespace tafoni::scene {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using volume::Precision;

constexpr std::string_view ground =
    "[scene]\nvoxel = 2\nseed = 5\nmin_fragment = 0\n[terrain]\ngenerator = \"plateau\"\nwidth = 60\n"
    "height = 50\npixel = 4\n";
constexpr std::string_view caves = "[[layer]]\ntype = \"primitives\"\nfile = \"caves.csv\"\n";

class VolumeScene : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream csv(root / "caves.csv");
    csv << "kind,x,y,z,energy,radius\n";
    Random random(3);
    for (int i = 0; i < 150; ++i)
      csv << "point," << random.uniform(20, 220) << "," << random.uniform(20, 180) << ","
          << random.uniform(265, 300) << "," << random.uniform(-14, -4) << "," << random.uniform(4, 11)
          << "\n";
  }

  Document document(std::string_view layers) const {
    return parse_scene(std::string(ground) + std::string(layers), root / "s.toml");
  }
  fs::path path(const std::string& name) const { return root / name; }
  /// Writes the scene as a volume.
  void save(const BuiltScene& scene, const std::string& name, volume::SampleSettings settings) const {
    io::write_volume(path(name), sample_scene(scene, settings));
  }
  /// A ball of rock of radius 20 m about the world point (120, 100, 290), its values limited to 6 m.
  void save_ball(const std::string& name, double radius = 20) const {
    const volume::GridFrame frame{{-24, -24, -24}, 1, {49, 49, 49}};
    io::Volume ball{volume::ScalarGrid(frame, -6), {120, 100, 290}, {}};
    ball.grid.edit(ball.grid.samples(), [&](Vec3i first, std::span<float> row) {
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = static_cast<float>(
            std::clamp(radius - length(frame.position(first + Vec3i{static_cast<int>(i), 0, 0})), -6.0, 6.0));
    });
    io::write_volume(path(name), ball);
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

struct Apart {
  double worst = 0;  ///< greatest distance of a vertex from the nearest one of the other mesh
  double share = 0;  ///< of the vertices that are further than `near` from it
};

Apart apart(const mesh::Mesh& a, const mesh::Mesh& b, double near_enough) {
  constexpr double cell = 0.1;  // beyond which nothing is found
  using Key = std::array<std::int64_t, 3>;
  const auto world = [](const mesh::Mesh& mesh, std::size_t i) {
    return to_double(mesh.positions[i]) + mesh.origin;
  };
  const auto key = [&](Vec3d p) {
    return Key{std::llround(p.x / cell), std::llround(p.y / cell), std::llround(p.z / cell)};
  };
  std::multimap<Key, Vec3d> near;
  for (std::size_t i = 0; i < b.positions.size(); ++i) near.emplace(key(world(b, i)), world(b, i));
  Apart out;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    const Vec3d p = world(a, i);
    double best = std::numeric_limits<double>::infinity();
    for (int n = 0; n < 27; ++n) {
      Key k = key(p);
      k[0] += n % 3 - 1, k[1] += n / 3 % 3 - 1, k[2] += n / 9 - 1;
      for (auto [at, end] = near.equal_range(k); at != end; ++at)
        best = std::min(best, length(at->second - p));
    }
    out.worst = std::max(out.worst, best);
    out.share += best > near_enough ? 1.0 / static_cast<double>(a.positions.size()) : 0;
  }
  return out;
}

TEST_F(VolumeScene, SavedAndBuiltAgainItIsTheSameMesh) {
  const BuiltScene scene = build(document(caves));
  const MeshResult direct = mesh_scene(scene);
  ASSERT_TRUE(mesh::validate(direct.mesh).valid());
  struct Case {
    const char* file;
    Precision precision;
    double tolerance;  // cells
  };
  // Half precision has steps of 2^-10 of the value. Where the field is so steep that a sample beside the
  // surface lies beyond the band, the surface moves a little.
  for (const Case& c : {Case{"a.tvol", Precision::single, 1e-4}, Case{"b.tvol", Precision::half, 5e-3},
                        Case{"a.vdb", Precision::single, 1e-4}, Case{"b.vdb", Precision::half, 5e-3}}) {
    try {
      save(scene, c.file, {c.precision, 4 * scene.voxel});
    } catch (const Error& error) {
      ASSERT_THAT(error.what(), HasSubstr("no OpenVDB"));
      continue;
    }
    const BuiltScene again = build(volume_document(path(c.file).string()));
    EXPECT_EQ(again.voxel, scene.voxel);
    Document copy = again.document;
    copy.scene.min_fragment = 0;
    const MeshResult result = mesh_scene(build(copy));
    EXPECT_EQ(result.mesh.triangles.size(), direct.mesh.triangles.size());
    for (const Apart& d : {apart(direct.mesh, result.mesh, c.tolerance * scene.voxel),
                           apart(result.mesh, direct.mesh, c.tolerance * scene.voxel)}) {
      EXPECT_LE(d.worst, 0.05 * scene.voxel) << c.file;
      EXPECT_LE(d.share, 1e-3) << c.file;
    }
    EXPECT_EQ(result.mesh.colors.size(), result.mesh.positions.size());
  }
}

/// Mean and greatest distance, to first order, of vertices to the field's surface.
std::pair<double, double> strays(const mesh::Mesh& mesh, const BuiltScene& scene) {
  const field::CompiledField field = scene.field_for(surface::Boundary::open);
  const Box3d inner = scene.terrain.box.grown(-3 * scene.voxel);
  std::vector<Vec3d> points;
  for (const Vec3f p : mesh.positions) {
    const Vec3d local = to_double(p) + mesh.origin - scene.terrain.origin;
    if (inner.contains(local)) points.push_back(local);
  }
  std::vector<float> values(points.size());
  std::vector<Vec3f> gradients(points.size());
  field.gradients(points, values, gradients);
  double sum = 0, worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d =
        std::abs(static_cast<double>(values[i])) / std::max(length(to_double(gradients[i])), 0.2);
    sum += d;
    worst = std::max(worst, d);
  }
  return {sum / static_cast<double>(points.size()), worst};
}

// Field to grid to field to mesh: the mesh is fine, so that what strays is the grid's doing.
TEST_F(VolumeScene, ErrorFallsWithTheSquareOfTheCell) {
  Document coarse = document("");
  double before = 0;
  for (const double cell : {4.0, 2.0, 1.0}) {
    coarse.scene.voxel = cell;
    const BuiltScene scene = build(coarse);
    save(scene, "a.tvol", {});
    Document again = volume_document(path("a.tvol").string());
    again.scene.voxel = 0.7;
    again.scene.boundary = "open";
    const auto [mean, worst] = strays(mesh_scene(build(again)).mesh, scene);
    EXPECT_LT(mean, 0.05 * cell);
    if (before > 0) {
      EXPECT_GT(before / mean, 2.5) << cell;
      EXPECT_LT(before / mean, 6) << cell;
    }
    before = mean;
  }
}

TEST_F(VolumeScene, ModesCombineRockAsTheySay) {
  save_ball("ball.tvol");
  const BuiltScene bare = build(document(""));
  const field::CompiledField below = bare.field_for(surface::Boundary::open);
  const Vec3d origin = bare.terrain.origin, center = Vec3d{120, 100, 290} - origin;
  Random random(1);
  for (const std::string mode : {"replace", "insert", "union", "intersection", "carve"}) {
    const BuiltScene scene =
        build(document("[[layer]]\ntype = \"volume\"\nfile = \"ball.tvol\"\nmode = \"" + mode + "\"\n"));
    const field::CompiledField field = scene.field_for(surface::Boundary::open);
    const Box3d& reshaped = scene.layers[0].made.reshaped;
    int rock = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3d p =
          center + Vec3d{random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-40, 40)};
      const double inside = 20 - length(p - center);
      if (std::abs(inside) < 0.05) continue;
      const float f = below.value(p), now = field.value(p);
      const bool a = f > 0, b = inside > 0,
                 box = std::max({std::abs(p.x - center.x), std::abs(p.y - center.y),
                                 std::abs(p.z - center.z)}) <= 24;
      const bool expected = mode == "replace"        ? b
                            : mode == "insert"       ? (box ? b : a)
                            : mode == "union"        ? a || b
                            : mode == "intersection" ? a && b
                                                     : a && !b;
      if (std::abs(f) > 1e-3f) {
        EXPECT_EQ(now > 0, expected) << mode << " " << inside << " " << f;
      }
      rock += now > 0;
      if (!reshaped.contains(p)) {
        EXPECT_EQ(now, f) << mode;
      }
      // Beyond the cells that reach into the band, rock is as deep as the scene's, although the volume's band
      // is narrower.
      if (mode == "union" && inside > 8) {
        EXPECT_EQ(now, 7.5f);
      }
    }
    EXPECT_GT(rock, 50) << mode;
  }
}

TEST_F(VolumeScene, PrunesExactly) {
  save_ball("ball.tvol");
  for (const char* mode : {"insert", "carve"}) {
    const BuiltScene scene = build(document("[[layer]]\ntype = \"volume\"\nfile = \"ball.tvol\"\nmode = \"" +
                                            std::string(mode) + "\"\nat = [118.3, 99.1, 291.7]\n"));
    EXPECT_GT(field::Lattice(scene.field_for(surface::Boundary::solid), 1.3).check(-1, 0, -1, 0), 10000u);
  }
}

TEST_F(VolumeScene, RockOnItsTopEndsThere) {
  const volume::GridFrame frame{{0, 0, 0}, 1, {96, 96, 96}};
  io::write_volume(path("block.tvol"), {volume::ScalarGrid(frame, 1), {0, 0, 0}, {}});
  const BuiltScene scene = build(volume_document(path("block.tvol")));
  const field::CompiledField field = scene.field_for(surface::Boundary::open);
  EXPECT_GT(field.value(Vec3d{40, 40, 94.9} - scene.terrain.origin), 0);
  EXPECT_LT(field.value(Vec3d{40, 40, 95.1} - scene.terrain.origin), 0);
  EXPECT_LT(field.bounds().hi.z + scene.terrain.origin.z, 100);
}

TEST_F(VolumeScene, RockOnItsTopIsToldAndNoOther) {
  for (const int rock_to : {95, 94, 90}) {
    io::Volume volume{volume::ScalarGrid({{0, 0, 0}, 1, {40, 40, 96}}, 1), {0, 0, 0}, {}};
    volume.grid.edit(volume.grid.samples(), [&](Vec3i first, std::span<float> row) {
      std::fill(row.begin(), row.end(), first.z <= rock_to ? 1.0f : -1.0f);
    });
    io::write_volume(path("block.tvol"), volume);
    HeardWarnings warnings;
    build(volume_document(path("block.tvol")), warnings);
    EXPECT_EQ(warnings.said.size(), rock_to == 95 ? 1u : 0u) << rock_to;
  }
}

TEST_F(VolumeScene, AtPutsTheMiddleOfItsBox) {
  save_ball("ball.tvol");
  const BuiltScene scene =
      build(document("[[layer]]\ntype = \"volume\"\nfile = \"ball.tvol\"\nat = [60, 70, 500.5]\n"));
  const field::CompiledField field = scene.field_for(surface::Boundary::open);
  const auto value = [&](Vec3d world) { return field.value(world - scene.terrain.origin); };
  EXPECT_GT(value({60, 70, 500.5}), 7);
  EXPECT_NEAR(value({80, 70, 500.5}), 0, 0.01);
  EXPECT_NEAR(value({60, 70, 519.5}), 1, 0.01);
  EXPECT_LT(value({120, 100, 290}), -7);
}

TEST_F(VolumeScene, MoreColumnsThanFitAreRefused) {
  volume::GridFrame frame;
  frame.size = {54000, 54000, 2};
  io::write_volume(path("wide.tvol"), {volume::ScalarGrid(frame, -1), {0, 0, 0}, {}});
  EXPECT_THAT(failure([&] { build(volume_document(path("wide.tvol").string())); }),
              HasSubstr("wide.tvol: 2916 million pixels need 47 GB of memory; make the volume at a larger"));
}

TEST_F(VolumeScene, ItsUpperSurfaceIsTheTerrain) {
  save_ball("ball.tvol");
  const io::Volume ball = io::read_volume(path("ball.tvol"));
  const raster::Raster heights = impl::heights_of(ball, "ball.tvol");
  EXPECT_EQ(heights.width(), 48);
  int high = 0;
  for (int row = 0; row < heights.height(); ++row)
    for (int col = 0; col < heights.width(); ++col) {
      const Vec2d p = heights.placement.center(col, row);
      const double h = heights.values.at(col, row);
      // A pixel has the highest of its cell's four columns.
      double expected = 290 - 24;
      for (const double dx : {-0.5, 0.5})
        for (const double dy : {-0.5, 0.5}) {
          const double r = std::hypot(p.x + dx - 120, p.y + dy - 100);
          if (r < 19.9) expected = std::max(expected, 290 + std::sqrt(400 - r * r));
        }
      const double r = std::hypot(p.x - 120, p.y - 100);
      if (r > 18.5 && r < 21.5) continue;  // where the ball ends the surface is upright
      EXPECT_NEAR(h, expected, 0.05) << p.x << " " << p.y;
      ++high;
    }
  EXPECT_GT(high, 1000);

  const MeshResult result = mesh_scene(build(volume_document(path("ball.tvol").string())));
  const mesh::MeshMetrics m = mesh::metrics(result.mesh);
  EXPECT_TRUE(mesh::validate(result.mesh).valid());
  EXPECT_TRUE(m.closed);
  EXPECT_NEAR(m.volume, 4 / 3.0 * std::acos(-1) * 8000, 60);
}

TEST_F(VolumeScene, LandformsActOnIt) {
  save_ball("ball.tvol");
  Document on_volume = volume_document(path("ball.tvol").string());
  Layer overhang;
  overhang.type = "primitives";
  std::ofstream(path("one.csv")) << "kind,x,y,z,energy,radius\npoint,120,100,310,-15,8\n";
  overhang.values["file"] = path("one.csv").string();
  on_volume.layers.push_back(overhang);
  const BuiltScene scene = build(on_volume);
  const field::CompiledField field = scene.field_for(surface::Boundary::solid);
  EXPECT_LT(field.value(Vec3d{120, 100, 308} - scene.terrain.origin), 0);
  EXPECT_GT(field.value(Vec3d{120, 100, 295} - scene.terrain.origin), 0);
}

TEST_F(VolumeScene, ASessionNoticesAnotherFile) {
  save_ball("ball.tvol", 20);
  Session session(document("[[layer]]\ntype = \"volume\"\nfile = \"ball.tvol\"\nmode = \"union\"\n"));
  EXPECT_THAT(session.update().rerun, ElementsAre("volume"));
  EXPECT_TRUE(session.update().rerun.empty());
  save_ball("ball.tvol", 15);
  const Update update = session.update();
  EXPECT_THAT(update.rerun, ElementsAre("volume"));
  const Vec3d p = Vec3d{120, 100, 290 + 17} - update.scene->terrain.origin;
  EXPECT_LT(update.scene->field_for(surface::Boundary::open).value(p), 0);
}

TEST_F(VolumeScene, ALevelSetIsTheScenesSolidWithASlopeOfOne) {
  Document own = document(caves);
  for (const char* boundary : {"solid", "open"}) {
    own.scene.boundary = boundary;
    const BuiltScene scene = build(own);
    const io::Volume set = level_set(scene, {.band = 3 * scene.voxel});
    EXPECT_EQ(set.origin, scene.terrain.origin);
    const volume::GridFrame& frame = set.grid.frame();
    const Interval range = set.grid.range(frame.box());
    EXPECT_GT(range.hi, 3 * scene.voxel);
    EXPECT_EQ(range.lo, -range.hi);
    // Each sample is on the side where the closed field has it, and neighbours differ by a cell at most.
    const field::CompiledField field = scene.field_for(surface::Boundary::solid);
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
      const Vec3i s{static_cast<int>(random.below(frame.size.x - 1)),
                    static_cast<int>(random.below(frame.size.y)),
                    static_cast<int>(random.below(frame.size.z))};
      ASSERT_EQ(set.grid.at(s) > 0, field.value(frame.position(s)) > 0);
      ASSERT_LE(std::abs(set.grid.at(s) - set.grid.at(s + Vec3i{1, 0, 0})), 1.0001 * frame.spacing);
    }
    io::write_volume(path("set.tvol"), set);
    Document again = volume_document(path("set.tvol").string());
    again.scene.min_fragment = 0;
    own.scene.boundary = "solid";
    EXPECT_NEAR(mesh::metrics(mesh_scene(build(again)).mesh).volume /
                    mesh::metrics(mesh_scene(build(own)).mesh).volume,
                1, 0.002)
        << boundary;
  }
}

TEST_F(VolumeScene, LevelSetsReachThreeCellsAtLeastAndFourteenAtMost) {
  const BuiltScene scene = build(document(caves));
  EXPECT_GT(level_set_reach(scene, 0.1), 3 * scene.voxel);
  EXPECT_EQ(level_set_reach(scene, 14 * scene.voxel), 14 * scene.voxel);
  for (const double band : {0.0, 14.1 * scene.voxel})
    EXPECT_THAT(failure([&] { level_set_reach(scene, band); }), HasSubstr("at most 14 cells"));
}

TEST_F(VolumeScene, WrongInputsAreOneSentence) {
  save_ball("ball.tvol");
  const auto said = [&](const std::string& layer) {
    return failure([&] { build(document("[[layer]]\ntype = \"volume\"\n" + layer)); });
  };
  EXPECT_THAT(said(""), HasSubstr("needs file"));
  EXPECT_THAT(said("file = \"none.tvol\"\n"), HasSubstr("none.tvol: does not exist"));
  EXPECT_THAT(said("file = \"s.glb\"\n"), HasSubstr("cannot be read as a volume"));
  EXPECT_THAT(said("file = \"ball.tvol\"\nmode = \"cut\"\n"), HasSubstr("carve"));
  EXPECT_THAT(said("file = \"ball.tvol\"\naltitude = [0, 5]\n"), HasSubstr("leave out region"));
  Document windowed = volume_document(path("ball.tvol").string());
  windowed.terrain.window = {0, 0, 5, 5};
  EXPECT_THAT(failure([&] { build(windowed); }), HasSubstr("leave out the window"));
  EXPECT_THAT(failure([&] {
                sample_scene(build(document(
                                 "[[layer]]\ntype = \"volume\"\nfile = \"ball.tvol\"\nat = [9e5, 9e5, 9e5]\n"
                                 "mode = \"intersection\"\n")),
                             {});
              }),
              HasSubstr("no surface"));
}

}  // namespace
}  // namespace tafoni::scene
