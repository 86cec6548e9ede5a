// A walker goes into a grammar cave and out again, by the route that the layer reports.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tafoni/core/test/test_folder.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/query/field_collider.h"
#include "tafoni/query/routes.h"
#include "tafoni/scene/build/build.h"

namespace tafoni::scene {
namespace {

std::vector<Vec3d> route_of(const BuiltScene& scene) {
  const auto* route = scene.layers.at(0).made.facts.find<landforms::Places>("route");
  return route ? route->local : std::vector<Vec3d>();
}

void walk_in_and_out(const Document& document, double voxel) {
  const BuiltScene scene = build(document);
  const field::CompiledField field = scene.field_for(surface::Boundary::solid);
  const query::FieldCollider ground(field, {.voxel = voxel});
  std::vector<Vec3d> way = route_of(scene);
  ASSERT_GE(way.size(), 6u);
  const field::CompiledField before =
      field::compile(field::heightfield(scene.terrain.heights, scene.settings));
  EXPECT_LT(before.value(way.front() + Vec3d{0, 0, 1}), 0) << "begins in the open";
  EXPECT_GT(before.value(way.back() + Vec3d{0, 0, 4}), 0) << "ends under the hill";

  query::Walker walker({}, way.front() + Vec3d{0, 0, 1});
  for (int i = 0; i < 40; ++i) walker.move(ground, {}, 0.05);
  ASSERT_TRUE(walker.grounded());
  const auto clear = [&](const query::Walker& w) {
    const auto contact = ground.contact(w.capsule());
    ASSERT_TRUE(!contact || contact->depth < 1e-4);
  };
  constexpr double move = 0.15, seconds = 0.1;
  EXPECT_TRUE(query::follow(ground, walker, way, move, seconds, clear).arrived);
  std::reverse(way.begin(), way.end());
  EXPECT_TRUE(query::follow(ground, walker, way, move, seconds, clear).arrived);
}

TEST(GrammarWalk, ThroughTheExample) {
  walk_in_and_out(load_scene(TAFONI_SOURCE_DIR "/examples/grammar_cave.toml"), 0.3);
}

/// A steep, uneven hillside at 1 m a pixel, above a beach: ribs and gullies, bumps of a few metres and
/// rubble.
void write_hillside(const std::filesystem::path& file, int width, int height) {
  std::ofstream out(file);
  out << "ncols " << width << "\nnrows " << height << "\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  for (int y = 0; y < height; ++y, out << "\n")
    for (int x = 0; x < width; ++x) {
      const double rib = 7 * std::sin(0.07 * y + 0.02 * x) + 3 * std::sin(0.19 * y - 1);
      const double rise = smoothstep(45.0, 80.0, x + rib);
      const double bumps = 1.6 * std::sin(0.31 * x + 0.2 * y) * std::sin(0.23 * y - 0.12 * x);
      const double rubble = 0.35 * std::sin(1.3 * x + 0.4 * y) * std::cos(1.1 * y);
      out << 2 + 52 * rise + 0.04 * x + bumps + rubble << " ";
    }
}

TEST(GrammarWalk, UnderAnUnevenHillside) {
  const TestFolder folder;
  const std::filesystem::path dem = folder.path / "hillside.asc";
  write_hillside(dem, 200, 190);
  Document document = load_scene(TAFONI_SOURCE_DIR "/examples/grammar_cave.toml");
  document.terrain.generator.clear();
  document.terrain.values.clear();
  document.terrain.source = dem.string();
  document.terrain.window = {20, 10, 160, 170};
  walk_in_and_out(document, 0.35);
}

}  // namespace
}  // namespace tafoni::scene
