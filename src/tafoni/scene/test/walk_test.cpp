// Walkers driven along random routes through the example scenes.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tafoni/query/field_collider.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/walks.h"
#include "tafoni/scene/products/mesh_scene.h"

namespace tafoni::scene {
namespace {

struct Expected {
  const char* scene;
  int routes;
  bool whole_mesh;  ///< measure the capsule against the mesh of the whole scene, too
  /// That the field may be above 0 on the capsule: what the voxel leaves out. Infinite where that is as much
  /// as the field ever is, since passages are as narrow as its falloff.
  double field;
};

/// How many of the points are rock in the field and at all corners of their lattice cells. The mesh is air
/// only in cells with a corner of air, so that none is where it is true to the field but for what its cells
/// cannot show.
int deep_in_rock(const field::CompiledField& field, double voxel, const std::vector<Vec3d>& points,
                 const std::vector<float>& values) {
  int deep = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(values[i] > 0)) continue;
    const Vec3d cell{std::floor(points[i].x / voxel), std::floor(points[i].y / voxel),
                     std::floor(points[i].z / voxel)};
    std::vector<Vec3d> corners;
    for (unsigned c = 0; c < 8; ++c)
      corners.push_back((cell + Vec3d{c & 1 ? 1.0 : 0.0, c & 2 ? 1.0 : 0.0, c & 4 ? 1.0 : 0.0}) * voxel);
    std::vector<float> around(corners.size());
    field.values(corners, around);
    deep += *std::min_element(around.begin(), around.end()) > 0;
  }
  return deep;
}

class Walks : public ::testing::TestWithParam<Expected> {};

// Together 1,000 routes; `tafoni query examples/NAME.toml --walk 1000` walks as many in each.
TEST_P(Walks, AreCompletedWithoutEnteringTheRock) {
  const Expected expected = GetParam();
  const BuiltScene scene =
      build(load_scene(std::string(TAFONI_SOURCE_DIR) + "/examples/" + expected.scene + ".toml"));
  const field::CompiledField field = scene.field_for(scene.boundary());
  surface::PolygonizeSettings settings = polygonize_settings(scene, scene.voxel);
  settings.min_fragment_volume = 0;
  settings.normals = false;
  const query::FieldCollider ground(field, {.voxel = scene.voxel, .region = settings.region});
  const query::MeshCollider mesh(expected.whole_mesh ? surface::polygonize(field, settings) : mesh::Mesh{});
  std::atomic<double> worst_value{-1e9}, worst_mesh{0};
  std::atomic<int> deep{0};
  const auto raise = [](std::atomic<double>& most, double value) {
    for (double seen = most; value > seen && !most.compare_exchange_weak(seen, value);) continue;
  };
  const auto check = [&](const query::Capsule& capsule) {
    const std::vector<Vec3d> points = query::surface_points(capsule, 0);
    std::vector<float> values(points.size());
    field.values(points, values);
    raise(worst_value, static_cast<double>(*std::max_element(values.begin(), values.end())));
    deep += deep_in_rock(field, scene.voxel, points, values);
    if (!expected.whole_mesh) return 0.0;
    for (Vec3d p : {capsule.a, (capsule.a + capsule.b) * 0.5, capsule.b})
      if (const auto near = mesh.closest(p, capsule.radius))
        raise(worst_mesh, capsule.radius - near->distance);
    return 0.0;
  };
  query::WalkSettings walk;
  walk.count = expected.routes;
  walk.around = 110;  // fewer starts, since looking for ways takes longer than going them
  walk.routes.places = 600;
  const auto walks = query::random_walks(ground, ground.bounds(), walk, check);
  ASSERT_EQ(static_cast<int>(walks.size()), expected.routes);
  double metres = 0;
  for (const query::Walk& w : walks) {
    EXPECT_TRUE(w.walked.arrived) << w.from.x << " " << w.from.y << " " << w.from.z;
    EXPECT_LT(w.overlap, 1e-6);
    EXPECT_GT(length(w.to - w.from), 0.4);
    metres += w.walked.metres;
  }
  EXPECT_GT(metres, 7 * expected.routes);
  EXPECT_LT(worst_mesh, 1e-6);
  EXPECT_EQ(deep, 0);
  EXPECT_LT(worst_value, expected.field);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Walks,
                         ::testing::Values(Expected{"karst", 340, true, INFINITY},
                                           Expected{"hive", 330, true, 0.3},
                                           Expected{"grammar_cave", 330, true, 0.3}),
                         [](const auto& of) { return std::string(of.param.scene); });

}  // namespace
}  // namespace tafoni::scene
