#include "tafoni/query/prism_collider.h"

#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/test/agreement.h"
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
  mesh::PrismMesher mesher;
  mesher.update(fields, {0, 0, fields.frame().nx - 1, fields.frame().ny - 1});
  mesh::Mesh all;
  for (int b = 0; b < mesher.chunks_y(); ++b)
    for (int a = 0; a < mesher.chunks_x(); ++a) {
      const mesh::PrismChunk& chunk = mesher.chunk({a, b});
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

}  // namespace
}  // namespace tafoni::query
