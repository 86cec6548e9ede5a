#include "tafoni/mesh/simplify.h"

#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/math/counts.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/surface/dense_grid.h"

namespace tafoni::mesh {
namespace {

using testing::IsEmpty;

template <class F>
Mesh surface(int nx, int ny, int nz, const F& f) {
  std::vector<float> values;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) values.push_back(static_cast<float>(f(to_double(Vec3i{i, j, k}))));
  Mesh mesh;
  surface::polygonize_grid({values.data(), nx, ny, nz, 1.0}, true, mesh);
  return mesh;
}

/// Rolling ground with tunnels and thin walls: what collapses easily into a pinched surface.
Mesh landscape(int n) {
  return surface(n, n, 40, [](Vec3d p) {
    const double ground = 22 + 6 * std::sin(p.x * 0.06) * std::cos(p.y * 0.05) - p.z;
    const Vec3d q = p * 0.35;
    return std::min(ground, 0.9 + std::sin(q.x) * std::cos(q.y) + std::sin(q.y) * std::cos(q.z) +
                                std::sin(q.z) * std::cos(q.x));
  });
}

using Point = std::array<float, 3>;
std::multiset<std::pair<Point, Point>> border(const Mesh& mesh) {
  std::multiset<std::pair<Point, Point>> edges;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) ++uses[std::minmax(t[c], t[(c + 1) % 3])];
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    const Vec3f a = mesh.positions[edge.first], b = mesh.positions[edge.second];
    edges.insert(std::minmax(Point{a.x, a.y, a.z}, Point{b.x, b.y, b.z}));
  }
  return edges;
}

TEST(Simplify, ReducesASphereWithinTheError) {
  const Vec3d center{40.2, 40.1, 40.3};
  const Mesh mesh = surface(81, 81, 81, [=](Vec3d p) { return 35 - length(p - center); });
  SimplifyStats stats;
  const Mesh small = simplify(mesh, {.error = 0.4, .normals = {}}, silent(), &stats);
  EXPECT_THAT(defects(validate(small)), IsEmpty());
  EXPECT_TRUE(validate(small).closed());
  EXPECT_EQ(metrics(small).genus, 0);
  EXPECT_LT(small.triangles.size(), mesh.triangles.size() / 8);
  EXPECT_EQ(stats.triangles_after, small.triangles.size());
  for (const auto& t : small.triangles) {
    const Vec3d middle = (to_double(small.positions[t[0]]) + to_double(small.positions[t[1]]) +
                          to_double(small.positions[t[2]])) *
                         (1.0 / 3);
    EXPECT_NEAR(length(middle - center), 35, 1.0);
  }
}

TEST(Simplify, PebblesVanishWithoutATrace) {
  const Mesh mesh = surface(60, 60, 40, [](Vec3d p) {
    const Vec3d q{std::remainder(p.x, 9.7), std::remainder(p.y, 9.3), p.z - 25};
    return std::max(10.3 - p.z, 1.4 - length(q));
  });
  const Mesh small = simplify(mesh, {.error = 4, .normals = {}});
  EXPECT_THAT(defects(validate(small)), IsEmpty());
  EXPECT_LT(metrics(small).components, metrics(mesh).components);
}

TEST(Simplify, OfFlatGroundLittleButTheBorderIsLeftHoweverLargeTheError) {
  // Patches that lie flat side by side have borders of points in a row, over which both would make one edge.
  const Mesh mesh = surface(
      420, 400, 6, [](Vec3d p) { return 2.6 + 0.1 * std::sin(p.x * 0.9) * std::cos(p.y * 0.7) - p.z; });
  const std::size_t at_border = border(mesh).size();
  std::size_t most = 4 * at_border;
  for (const double error : {0.5, 1.0, 2.0, 4.0}) {
    const Mesh small = simplify(mesh, {.error = error, .normals = {}});
    EXPECT_THAT(defects(validate(small)), IsEmpty());
    EXPECT_EQ(border(small), border(mesh));
    EXPECT_LT(small.triangles.size(), most) << error;
    most = small.triangles.size() + at_border;
  }
}

TEST(Simplify, FlatFacesLoseNoArea) {
  // A block with walls exactly on lattice planes: its collinear vertices tempt collapses into empty
  // triangles.
  const Mesh mesh = surface(90, 80, 40, [](Vec3d p) {
    return std::min({p.x - 10.25, 75.25 - p.x, p.y - 10.5, 70.5 - p.y, p.z - 5.5, 30.5 - p.z});
  });
  const Mesh small = simplify(mesh, {.error = 0.1, .normals = {}});
  EXPECT_THAT(defects(validate(small)), IsEmpty());
  EXPECT_LT(small.triangles.size(), mesh.triangles.size() / 20);
  EXPECT_NEAR(metrics(small).volume, metrics(mesh).volume, 0.002 * metrics(mesh).volume);
  EXPECT_NEAR(metrics(small).area, metrics(mesh).area, 0.005 * metrics(mesh).area);
}

TEST(Simplify, KeepsManifoldnessAndOpenBorders) {
  const Mesh mesh = landscape(140);
  ASSERT_THAT(defects(validate(mesh)), IsEmpty());
  for (double error : {0.2, 1.0, 5.0}) {
    SimplifyStats stats;
    const Mesh small = simplify(mesh, {.error = error, .normals = {}}, silent(), &stats);
    EXPECT_THAT(defects(validate(small)), IsEmpty()) << error;
    EXPECT_LT(ratio(small.triangles.size(), mesh.triangles.size()), error < 0.5 ? 0.6 : 0.4) << error;
    EXPECT_LT(stats.patches_rejected, stats.patches / 2);
    EXPECT_TRUE(border(small) == border(mesh));
    EXPECT_GT(stats.patches, 8u);
  }
}

/// Some triangles of a mesh as a mesh of their own.
Mesh piece(const Mesh& mesh, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Mesh out;
  std::map<std::uint32_t, std::uint32_t> index;
  for (const auto& t : triangles) {
    out.triangles.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [at, fresh] = index.try_emplace(t[c], static_cast<std::uint32_t>(index.size()));
      if (fresh) out.positions.push_back(mesh.positions[t[c]]);
      out.triangles.back()[c] = at->second;
    }
  }
  return out;
}

/// The columns of a mesh, each simplified by itself, and joined where positions are the same.
Mesh joined_tiles(const Mesh& mesh, float side, double error, bool seams) {
  std::map<std::pair<int, int>, std::vector<std::array<std::uint32_t, 3>>> tiles;
  for (const auto& t : mesh.triangles) {
    const Vec3f p = mesh.positions[t[0]];
    tiles[{static_cast<int>(p.x / side), static_cast<int>(p.y / side)}].push_back(t);
  }
  Mesh out;
  std::map<Point, std::uint32_t> index;
  for (const auto& [place, triangles] : tiles) {
    const Mesh small = simplify(piece(mesh, triangles), {.error = error, .seams = seams, .normals = {}});
    for (const auto& t : small.triangles) {
      out.triangles.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3f p = small.positions[t[c]];
        const auto [at, fresh] =
            index.try_emplace(Point{p.x, p.y, p.z}, static_cast<std::uint32_t>(index.size()));
        if (fresh) out.positions.push_back(p);
        out.triangles.back()[c] = at->second;
      }
    }
  }
  return out;
}

TEST(Simplify, TilesJoinedAreManifold) {
  const Mesh mesh = landscape(140);
  std::uint64_t without = 0;
  for (const double error : {1.0, 5.0}) {
    const Mesh loose = joined_tiles(mesh, 47, error, false);
    without += validate(loose).non_manifold_edges;
    const Mesh joined = joined_tiles(mesh, 47, error, true);
    EXPECT_THAT(defects(validate(joined)), IsEmpty()) << error;
    EXPECT_TRUE(border(joined) == border(mesh));
    // What keeps the seams apart is little.
    EXPECT_LT(static_cast<double>(joined.triangles.size()),
              1.2 * static_cast<double>(loose.triangles.size()));
  }
  EXPECT_GT(without, 0u);
}

TEST(Simplify, APieceThatCollapsesOntoAnotherLeavesNoHole) {
  const Mesh mesh = landscape(140);
  EXPECT_TRUE(border(joined_tiles(mesh, 70, 1, false)) == border(mesh));
}

TEST(Simplify, DoesNotDependOnThreads) {
  const Mesh mesh = landscape(120);
  set_thread_count(1);
  const Mesh one = simplify(mesh, {.error = 0.5, .normals = {}});
  set_thread_count(2);
  const Mesh two = simplify(mesh, {.error = 0.5, .normals = {}});
  set_thread_count(0);
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST(Simplify, CarriesOriginColoursAndNormals) {
  Mesh mesh = landscape(60);
  mesh.origin = {1, 2, 3};
  for (const Vec3f& p : mesh.positions)
    mesh.colors.push_back({static_cast<std::uint8_t>(p.x), static_cast<std::uint8_t>(p.y), 0, 255});
  const Mesh small = simplify(mesh, {.error = 0.5, .normals = {}});
  EXPECT_EQ(small.origin, mesh.origin);
  ASSERT_EQ(small.colors.size(), small.positions.size());
  ASSERT_EQ(small.normals.size(), small.positions.size());
  for (std::size_t v = 0; v < small.positions.size(); ++v)
    EXPECT_EQ(small.colors[v][0], static_cast<std::uint8_t>(small.positions[v].x));
  const Mesh fresh =
      simplify(mesh, {.error = 0.5, .normals = [](std::span<const Vec3f>, std::span<Vec3f> normals) {
                        for (Vec3f& n : normals) n = {0, 0, 1};
                      }});
  for (const Vec3f& n : fresh.normals) EXPECT_EQ(n, (Vec3f{0, 0, 1}));
}

TEST(Simplify, NoErrorOrNoMeshChangesNothing) {
  const Mesh mesh = landscape(40);
  const Mesh same = simplify(mesh, {.error = 0, .normals = {}});
  EXPECT_EQ(same.positions, mesh.positions);
  EXPECT_EQ(same.triangles, mesh.triangles);
  EXPECT_TRUE(simplify({}, {.error = 1, .normals = {}}).triangles.empty());
  EXPECT_THAT(error_of([&] { simplify(mesh, {.error = -1, .normals = {}}); }),
              ::testing::HasSubstr("an error of -1 m cannot be used to simplify"));
}

}  // namespace
}  // namespace tafoni::mesh
