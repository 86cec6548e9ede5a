#include "tafoni/mesh/metrics.h"

#include <fstream>

#include <gmock/gmock.h>

namespace tafoni::mesh {
namespace {

Mesh box_mesh(Vec3f lo, Vec3f hi) {
  Mesh m;
  for (int c = 0; c < 8; ++c)
    m.positions.push_back({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z});
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

TEST(Metrics, MeasuresABox) {
  Mesh m = box_mesh({1, 2, 3}, {3, 5, 7});
  m.origin = {500000, 4000000, 100};
  const MeshMetrics r = metrics(m);
  EXPECT_DOUBLE_EQ(r.area, 2 * (2 * 3 + 3 * 4 + 2 * 4));
  EXPECT_DOUBLE_EQ(r.volume, 24);
  EXPECT_EQ(r.euler, 2);
  EXPECT_EQ(r.genus, 0);
  EXPECT_TRUE(r.closed);
  EXPECT_EQ(r.bounds.lo, (Vec3d{500001, 4000002, 103}));
  EXPECT_EQ(r.bounds.hi, (Vec3d{500003, 4000005, 107}));
  EXPECT_EQ(r.shortest_edge, 2);
  EXPECT_EQ(r.longest_edge, 5);
  EXPECT_EQ(r.edges, 18u);
}

TEST(Metrics, VolumeKeepsItsDigitsFarFromZero) {
  EXPECT_DOUBLE_EQ(metrics(box_mesh({1e6f, 2e6f, 0}, {1e6f + 2, 2e6f + 2, 2})).volume, 8);
}

TEST(Metrics, CountsLoopsOfAnOpenTube) {
  Mesh m = box_mesh({0, 0, 0}, {1, 1, 1});
  m.triangles.erase(m.triangles.begin(), m.triangles.begin() + 4);
  const MeshMetrics r = metrics(m);
  EXPECT_FALSE(r.closed);
  EXPECT_EQ(r.boundary_loops, 2u);
  EXPECT_EQ(r.genus, 0);
  EXPECT_DOUBLE_EQ(r.area, 4);
}

TEST(Metrics, SeveralPartsAndStrayVertices) {
  Mesh m = box_mesh({0, 0, 0}, {1, 1, 1});
  const Mesh other = box_mesh({3, 0, 0}, {4, 1, 1});
  m.positions.push_back({7, 7, 7});
  m.positions.insert(m.positions.end(), other.positions.begin(), other.positions.end());
  for (auto t : other.triangles) m.triangles.push_back({t[0] + 9, t[1] + 9, t[2] + 9});
  const MeshMetrics r = metrics(m);
  EXPECT_EQ(r.components, 2u);
  EXPECT_EQ(r.vertices, 16u);
  EXPECT_EQ(r.genus, 0);
  EXPECT_EQ(r.bounds.hi.x, 4);
  std::uint32_t count = 0;
  const auto parts = vertex_components(m, &count);
  EXPECT_EQ(count, 3u);
  EXPECT_EQ(parts[7], 0u);
  EXPECT_EQ(parts[8], 1u);
  EXPECT_EQ(parts[16], 2u);
}

TEST(Metrics, AgreesWithAKnownCave) {
  std::ifstream in(TAFONI_SOURCE_DIR "/tests/data/ring_cave.off");
  std::string magic;
  std::size_t vertices = 0, faces = 0, edges = 0, corners = 0;
  in >> magic >> vertices >> faces >> edges;
  ASSERT_EQ(magic, "OFF");
  Mesh m;
  m.positions.resize(vertices);
  m.triangles.resize(faces);
  for (Vec3f& p : m.positions) in >> p.x >> p.y >> p.z;
  for (auto& t : m.triangles) in >> corners >> t[0] >> t[1] >> t[2];
  ASSERT_TRUE(in);
  const MeshMetrics r = metrics(m);
  EXPECT_TRUE(r.closed);
  EXPECT_NEAR(r.area, 7352.590, 0.01);
  EXPECT_NEAR(r.volume, 21144.719, 0.05);
  EXPECT_EQ(r.genus, 1);
}

TEST(Metrics, NothingIsNothing) {
  const MeshMetrics r = metrics({});
  EXPECT_EQ(r.area, 0);
  EXPECT_FALSE(r.closed);
  EXPECT_TRUE(r.bounds.empty());
}

}  // namespace
}  // namespace tafoni::mesh
