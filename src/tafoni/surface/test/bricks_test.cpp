#include "tafoni/surface/inner/bricks.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::surface {
namespace {

using Corners = std::array<std::array<float, 3>, 3>;

void collect(const mesh::Mesh& mesh, std::vector<Corners>& out) {
  for (const auto& t : mesh.triangles) {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = mesh.positions[t[k]];
      c[k] = {p.x, p.y, p.z};
    }
    out.push_back(c);
  }
}

TEST(BrickPolygonizer, AllBoxesOfBricksTogetherAreTheMesh) {
  field::CloudBuilder cloud(field::CloudSettings{});
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const double x = random.uniform(-20, 20), y = random.uniform(-20, 20);
    field::add_point(cloud, {x, y, random.uniform(-20, 20)}, random.uniform(4, 9), 6);
  }
  const auto field = field::compile(field::blend({field::constant(-1), cloud.finish()}));
  PolygonizeSettings settings;
  settings.voxel = 0.7;
  settings.normals = false;
  std::vector<Corners> whole, parts;
  collect(polygonize(field, settings), whole);
  ASSERT_GT(whole.size(), 5000u);

  field::ChunkEvaluator evaluator(field, settings.voxel);
  BrickPolygonizer polygonizer(settings.voxel, field.bounds());
  field::ChunkSamples samples;
  mesh::Mesh mesh;
  for (int b = -1; b <= 0; ++b)
    for (int a = -1; a <= 0; ++a) {
      const auto range = evaluator.column(a, b);
      for (int c = range.first; c <= range.last; ++c)
        for (int box = 0; box < 64; ++box) {
          const Vec3i lo{2 * (box & 3), 2 * (box >> 2 & 3), 2 * (box >> 4)};
          const field::BrickBox bricks{lo, {lo.x + 1, lo.y + 1, lo.z + 1}};
          if (!evaluator.evaluate(c, bricks, samples)) continue;
          polygonizer.polygonize(samples, bricks, mesh);
          EXPECT_EQ(mesh.normals.size(), 0u);
          collect(mesh, parts);
        }
    }
  std::sort(whole.begin(), whole.end());
  std::sort(parts.begin(), parts.end());
  EXPECT_EQ(whole, parts);
}

TEST(BrickPolygonizer, BadVoxelsAreErrors) {
  EXPECT_THAT(error_of([&] {
                BrickPolygonizer(0, {{0, 0, 0}, {1, 1, 1}});
              }),
              ::testing::HasSubstr("a voxel of 0 m cannot be used"));
  EXPECT_THAT(error_of([&] {
                BrickPolygonizer(1e-9, {{0, 0, 0}, {1, 1, 1}});
              }),
              ::testing::HasSubstr("too far for single precision"));
}

}  // namespace
}  // namespace tafoni::surface
