#include "tafoni/mesh/validate.h"

#include <limits>

#include <gmock/gmock.h>

#include "tafoni/mesh/inner/size32.h"

namespace tafoni::mesh {
namespace {

using testing::IsEmpty;
using testing::Not;

/// A tetrahedron with outward normals.
Mesh tetrahedron(Vec3f at = {}) {
  Mesh m;
  const float s = 0.57735027f;
  m.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  m.normals = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}};
  for (Vec3f& p : m.positions) p += at;
  m.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return m;
}

void append(Mesh& to, const Mesh& from) {
  const auto first = inner::size32(to.positions);
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  to.normals.insert(to.normals.end(), from.normals.begin(), from.normals.end());
  for (auto t : from.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

TEST(Validate, FindsNothingWrongWithATetrahedron) {
  const MeshReport r = validate(tetrahedron());
  EXPECT_TRUE(r.valid());
  EXPECT_TRUE(r.closed());
  EXPECT_EQ(r.components, 1u);
  EXPECT_EQ(r.slivers, 0u);
  EXPECT_EQ(r.flipped_normals, 0u);
  EXPECT_THAT(defects(r), IsEmpty());
}

TEST(Validate, CountsBoundaryAndComponents) {
  Mesh m = tetrahedron();
  append(m, tetrahedron({5, 0, 0}));
  EXPECT_EQ(validate(m).components, 2u);
  m.triangles.pop_back();
  const MeshReport r = validate(m);
  EXPECT_EQ(r.boundary_edges, 3u);
  EXPECT_FALSE(r.closed());
  EXPECT_TRUE(r.valid());  // an open sheet is a legitimate mesh
}

TEST(Validate, FindsATurnedTriangle) {
  Mesh m = tetrahedron();
  std::swap(m.triangles[2][0], m.triangles[2][1]);
  EXPECT_EQ(validate(m).orientation_conflicts, 3u);
  EXPECT_FALSE(validate(m).valid());
}

TEST(Validate, FindsEdgesOfThreeTriangles) {
  Mesh m = tetrahedron();
  m.positions.push_back({3, 0, 0});
  m.normals.push_back({1, 0, 0});
  m.triangles.push_back({0, 1, 4});
  const MeshReport r = validate(m);
  EXPECT_EQ(r.non_manifold_edges, 1u);
  EXPECT_FALSE(r.valid());
}

TEST(Validate, FindsPiecesThatMeetInAVertexOnly) {
  Mesh m = tetrahedron();
  Mesh other = tetrahedron({2, 2, 2});  // its vertex 3 would be elsewhere; join its vertex 0 to the first's
  append(m, other);
  for (auto& t : m.triangles)
    for (auto& v : t)
      if (v == 4) v = 0;
  m.positions.erase(m.positions.begin() + 4);
  m.normals.erase(m.normals.begin() + 4);
  for (auto& t : m.triangles)
    for (auto& v : t)
      if (v > 4) --v;
  const MeshReport r = validate(m);
  EXPECT_EQ(r.non_manifold_vertices, 1u);
  EXPECT_EQ(r.boundary_edges, 0u);
  EXPECT_FALSE(r.valid());
}

TEST(Validate, FindsDegenerateAndDuplicateTriangles) {
  Mesh m = tetrahedron();
  m.triangles.push_back({1, 1, 2});
  EXPECT_EQ(validate(m).degenerate_triangles, 1u);
  m = tetrahedron();
  m.positions[1] = m.positions[0];
  EXPECT_EQ(validate(m).degenerate_triangles, 2u);
  m = tetrahedron();
  m.triangles.push_back({2, 0, 1});
  m.triangles.push_back({1, 0, 2});
  EXPECT_EQ(validate(m).duplicate_triangles, 2u);
}

TEST(Validate, RemarksSlivers) {
  Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, 0.001f, 0}};
  m.triangles = {{0, 1, 2}};
  EXPECT_EQ(validate(m).slivers, 1u);
  EXPECT_TRUE(validate(m).valid());
  m.positions[2] = {0.5f, 0.5f, 0};
  EXPECT_EQ(validate(m).slivers, 0u);
}

TEST(Validate, FindsBadIndicesPositionsAndUnusedVertices) {
  Mesh m = tetrahedron();
  m.triangles.push_back({0, 1, 4});
  EXPECT_EQ(validate(m).index_errors, 1u);
  EXPECT_FALSE(validate(m).valid());
  m = tetrahedron();
  m.positions[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(validate(m).bad_positions, 1u);
  m = tetrahedron();
  m.positions.push_back({9, 9, 9});
  m.normals.push_back({0, 0, 1});
  EXPECT_EQ(validate(m).unused_vertices, 1u);
  EXPECT_THAT(defects(validate(m)), Not(IsEmpty()));
}

TEST(Validate, FindsBadNormals) {
  Mesh m = tetrahedron();
  m.normals[0] = {0, 0, 0};
  m.normals[1].x = std::numeric_limits<float>::infinity();
  EXPECT_EQ(validate(m).bad_normals, 2u);
  m = tetrahedron();
  m.normals.pop_back();
  EXPECT_FALSE(validate(m).valid());
  m = tetrahedron();
  for (Vec3f& n : m.normals) n = -n;
  EXPECT_EQ(validate(m).flipped_normals, 4u);
}

TEST(Validate, AnEmptyMeshIsValidButNotClosed) {
  const MeshReport r = validate({});
  EXPECT_TRUE(r.valid());
  EXPECT_FALSE(r.closed());
}

}  // namespace
}  // namespace tafoni::mesh
