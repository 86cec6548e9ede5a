#include "tafoni/surface/dense_grid.h"

#include <numbers>

#include <gmock/gmock.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"

namespace tafoni::surface {
namespace {

using std::numbers::pi;

struct Samples {
  template <class F>
  Samples(int x, int y, int z, double spacing, const F& f) : grid{nullptr, x, y, z, spacing} {
    for (int k = 0; k < z; ++k)
      for (int j = 0; j < y; ++j)
        for (int i = 0; i < x; ++i)
          values.push_back(static_cast<float>(f({i * spacing, j * spacing, k * spacing})));
    grid.samples = values.data();
  }
  DenseGrid grid;
  std::vector<float> values;
};

TEST(Dense, EllipsoidInAnOddlySizedGrid) {
  const Vec3d center{34, 20, 16};
  const auto f = [=](Vec3d p) {
    const Vec3d q = p - center;
    return 1 - std::sqrt(q.x * q.x / 900 + q.y * q.y / 289 + q.z * q.z / 169);
  };
  const Samples s(137, 83, 66, 0.5, f);
  mesh::Mesh mesh;
  polygonize_grid(s.grid, true, mesh);
  const mesh::MeshReport report = mesh::validate(mesh);
  EXPECT_TRUE(report.valid());
  EXPECT_TRUE(report.closed());
  EXPECT_EQ(report.flipped_normals, 0u);
  const mesh::MeshMetrics m = mesh::metrics(mesh);
  EXPECT_EQ(m.genus, 0);
  EXPECT_NEAR(m.volume, 4 * pi / 3 * 30 * 17 * 13, 0.003 * m.volume);
  double worst = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d q = to_double(mesh.positions[v]) - center;
    const Vec3d n = normalized(Vec3d{q.x / 900, q.y / 289, q.z / 169});
    worst = std::max(worst, length(n - to_double(mesh.normals[v])));
  }
  EXPECT_LT(worst, 0.01);
}

TEST(Dense, RandomSignsAreManifoldAtEverySize) {
  for (const Vec3i size :
       {Vec3i{2, 2, 2}, Vec3i{64, 5, 4}, Vec3i{65, 4, 5}, Vec3i{66, 3, 3}, Vec3i{129, 20, 9}}) {
    Random random(7, size.x);
    const Samples s(size.x, size.y, size.z, 1.0, [&](Vec3d) { return random.uniform(-1, 1); });
    mesh::Mesh mesh;
    polygonize_grid(s.grid, true, mesh);
    EXPECT_THAT(mesh::defects(mesh::validate(mesh)), testing::IsEmpty()) << size.x;
    for (const Vec3f& p : mesh.positions) {
      EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.z >= 0);
      EXPECT_TRUE(p.x <= static_cast<float>(size.x - 1) && p.y <= static_cast<float>(size.y - 1) &&
                  p.z <= static_cast<float>(size.z - 1));
    }
  }
}

TEST(Dense, ReusesItsOutput) {
  const Samples s(40, 40, 40, 1.0, [](Vec3d p) { return 12 - length(p - Vec3d{20, 20, 20}); });
  mesh::Mesh mesh;
  polygonize_grid(s.grid, true, mesh);
  const mesh::Mesh first = mesh;
  polygonize_grid(s.grid, true, mesh);
  EXPECT_EQ(first.positions, mesh.positions);
  EXPECT_EQ(first.normals, mesh.normals);
  EXPECT_EQ(first.triangles, mesh.triangles);
  polygonize_grid(s.grid, false, mesh);
  EXPECT_TRUE(mesh.normals.empty());
}

TEST(Dense, RefusesASlice) {
  const float samples[4] = {};
  mesh::Mesh mesh;
  EXPECT_THAT(error_of([&] {
                polygonize_grid({samples, 2, 2, 1, 1.0}, true, mesh);
              }),
              ::testing::HasSubstr("a grid of 2 x 2 x 1 samples cannot be meshed"));
}

}  // namespace
}  // namespace tafoni::surface
