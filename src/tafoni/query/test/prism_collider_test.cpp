#include "tafoni/query/prism_collider.h"

#include <cmath>

#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/test/agreement.h"
#include "tafoni/query/walker.h"
#include "tafoni/volume/prism_convert.h"
#include "tafoni/volume/tool.h"

namespace tafoni::query {
namespace {

using volume::PrismFields;
using volume::Tool;

/// A block of ground with random holes and bridges.
PrismFields dug(Vec3d origin, int tools, std::uint64_t seed) {
  PrismFields fields = volume::prism_box({origin, 0.5, 0.5, 81, 73}, 0, 12);
  Random random(seed);
  for (int i = 0; i < tools; ++i) {
    const Vec3d at = origin + Vec3d{random.uniform(0, 40), random.uniform(0, 36), random.uniform(0, 14)};
    const Vec3d half{random.uniform(1, 3), random.uniform(1, 3), random.uniform(0.5, 2)};
    const Tool tool =
        i % 3 ? Tool::sphere(at, random.uniform(1.5, 4)) : Tool::box(at, half, random.uniform(0, 3));
    fields.apply(tool, i % 4 ? volume::Edit::remove : volume::Edit::add);
  }
  return fields;
}

/// All chunks that are drawn.
mesh::Mesh local_mesh(const PrismFields& fields) {
  surface::PrismMesher mesher;
  mesher.update(fields, {0, 0, fields.frame().nx - 1, fields.frame().ny - 1});
  mesh::Mesh all;
  for (const Vec3i at : mesher.chunks()) {
    const surface::PrismChunkMesh& chunk = mesher.chunk(at);
    mesh::Mesh part;
    part.triangles = chunk.triangles;
    for (const Vec3f& p : chunk.positions)
      part.positions.push_back(to_float(fields.frame().origin + to_double(p)));
    testing::append(all, part);
  }
  return all;
}

TEST(PrismCollider, AgreesWithTheMesh) {
  for (Vec3d origin : {Vec3d{}, Vec3d{-311.7, 42.2, 5.1}}) {
    const PrismFields fields = dug(origin, 40, 1);
    testing::expect_agreement(PrismCollider(fields), MeshCollider(local_mesh(fields)), fields.bounds(), 1500,
                              1e-12, 2);
  }
}

TEST(PrismCollider, AnEditIsMetWhereItIs) {
  PrismFields fields = dug({}, 25, 3);
  PrismCollider collider(fields);
  const volume::ColumnBox changed =
      fields.apply(Tool::capsule({5, 5, 6}, {35, 30, 7}, 2.2), volume::Edit::remove);
  collider.update(fields, changed);
  testing::expect_agreement(collider, MeshCollider(local_mesh(fields)), fields.bounds(), 800, 1e-12, 4);
  const auto hit = collider.ray({5, 5, 6}, {30, 25, 1}, 20);
  EXPECT_FALSE(hit);
}

// A tunnel through a hill, in at one mouth and out at the other and back, the terrain being a raster.
TEST(PrismCollider, AWalkerPassesATunnel) {
  raster::Raster hill;
  hill.placement = {0, 60, 0.5, 0.5};
  hill.values = raster::Grid<float>(160, 120);
  for (int row = 0; row < 120; ++row)
    for (int col = 0; col < 160; ++col) {
      const Vec2d at = hill.placement.center(col, row);
      hill.values.at(col, row) = static_cast<float>(15 * std::exp(-(at.x - 40) * (at.x - 40) / 120) +
                                                    0.1 * std::sin(at.x) * std::cos(0.7 * at.y));
    }
  PrismFields fields = volume::prism_from(hill, -5);
  fields.apply(volume::Tool::capsule({10, 28, 1.9}, {70, 33, 1.9}, 2), volume::Edit::remove);
  EXPECT_EQ(fields.layers(), 2);
  const PrismCollider ground(fields);
  for (const double way : {1.0, -1.0}) {
    Walker walker({}, {40 - 28 * way, 30.5 - 28 * way * 5 / 60, 1.5});
    const Vec3d wish = normalized(Vec3d{60 * way, 5 * way, 0}) * 1.5;
    double highest = -1e9;
    for (int n = 0; n < 1500 && (walker.feet().x - 40) * way < 28; ++n) {
      walker.move(ground, wish, 1.0 / 30);
      ASSERT_FALSE(walker.stuck());
      ASSERT_FALSE(
          ground.overlaps(Capsule{walker.capsule().a, walker.capsule().b, walker.capsule().radius - 1e-5}));
      highest = std::max(highest, walker.feet().z);
    }
    EXPECT_GT((walker.feet().x - 40) * way, 27.9) << walker.feet().x;
    EXPECT_LT(highest, 2);  // through the hill, not over it
  }
}

}  // namespace
}  // namespace tafoni::query
