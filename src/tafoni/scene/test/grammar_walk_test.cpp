// A walker goes into a grammar cave and out again, by the route that the layer reports.

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

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

TEST(GrammarWalk, UnderARealHillside) {
  const std::filesystem::path dem = TAFONI_SOURCE_DIR "/../shared/data/dem/pointsal_seacliff_1m.tif";
  if (!std::filesystem::exists(dem)) GTEST_SKIP() << dem << " is not here";
  Document document = load_scene(TAFONI_SOURCE_DIR "/examples/grammar_cave.toml");
  document.terrain.generator.clear();
  document.terrain.values.clear();
  document.terrain.source = dem.string();
  document.terrain.window = {40, 530, 160, 170};
  walk_in_and_out(document, 0.35);
}

}  // namespace
}  // namespace tafoni::scene
