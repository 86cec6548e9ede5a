#include "tafoni/query/grid_collider.h"

#include <gmock/gmock.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/query/test/agreement.h"
#include "tafoni/volume/edit.h"

namespace tafoni::query {
namespace {

volume::ScalarGrid wavy(Vec3d origin) {
  volume::ScalarGrid grid({origin, 0.5, {66, 60, 48}}, -1);
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double x = 0.3 * (first.x + static_cast<int>(i)), y = 0.27 * first.y, z = 0.33 * first.z;
      row[i] = static_cast<float>(std::sin(x) + std::sin(y) + std::sin(z) + 0.4 * std::cos(2 * x + y));
    }
  });
  return grid;
}

mesh::Mesh mesh_of(const volume::ScalarGrid& grid) {
  surface::GridMesher mesher({surface::Boundary::solid, false});
  mesher.update(grid, {});
  return mesher.assemble();
}

TEST(GridCollider, AgreesWithTheMesh) {
  for (Vec3d origin : {Vec3d{}, Vec3d{-712.3, 55.1, 9.7}}) {
    const volume::ScalarGrid grid = wavy(origin);
    testing::expect_agreement(GridCollider(grid), MeshCollider(mesh_of(grid)), grid.frame().box(), 1500,
                              1e-12, 1);
  }
}

TEST(GridCollider, AnEditIsMetWhereItIs) {
  volume::ScalarGrid grid = wavy({});
  GridCollider collider(grid);
  volume::SampleBox changed = grid.edit({{10, 10, 10}, {40, 30, 40}}, [](Vec3i, std::span<float> row) {
    for (float& v : row) v = -v;
  });
  collider.update(grid, {&changed, 1});
  testing::expect_agreement(collider, MeshCollider(mesh_of(grid)), grid.frame().box(), 800, 1e-12, 2);
  const volume::ScalarGrid other({{}, 1, {4, 4, 4}}, 1);
  EXPECT_THAT(error_of([&] { collider.update(other, {}); }),
              ::testing::HasSubstr("make a new one for another frame"));
}

}  // namespace
}  // namespace tafoni::query
