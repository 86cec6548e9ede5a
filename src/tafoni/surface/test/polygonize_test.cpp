#include "tafoni/surface/polygonize.h"

#include <array>
#include <cstring>
#include <map>
#include <numbers>
#include <set>

#include <gmock/gmock.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/math/whole.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/surface/test/analytic_source.h"

namespace tafoni::surface {
namespace {

using std::numbers::pi;
using test::mesh_of;
using test::sphere;
using test::torus;

PolygonizeSettings solid(double voxel, Box3d region) {
  PolygonizeSettings s;
  s.voxel = voxel;
  s.region = region;
  return s;
}

Box3d cube(double half) {
  return {{-half, -half, -half}, {half, half, half}};
}

void expect_valid(const mesh::Mesh& mesh) {
  const mesh::MeshReport report = mesh::validate(mesh);
  EXPECT_THAT(mesh::defects(report), testing::IsEmpty());
  EXPECT_EQ(report.flipped_normals, 0u);
}

void expect_closed(const mesh::Mesh& mesh) {
  expect_valid(mesh);
  EXPECT_EQ(mesh::validate(mesh).boundary_edges, 0u);
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
bool same_bytes(const mesh::Mesh& a, const mesh::Mesh& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.normals, b.normals) &&
         same_bytes(a.triangles, b.triangles);
}

// 16 bits name 65,536 vertices: of both sides of that, no edge is longer than a cell.
TEST(Polygonize, ChunksOfAnyNumberOfVerticesHaveWholeTriangles) {
  for (const double wave : {4.0, 20.0}) {
    const double k = 2 * pi / wave;
    const test::Function gyroid = [=](Vec3d p) {
      return std::sin(k * p.x) * std::cos(k * p.y) + std::sin(k * p.y) * std::cos(k * p.z) +
             std::sin(k * p.z) * std::cos(k * p.x) + 0.01;
    };
    PolygonizeSettings settings = solid(1, {{2, 2, 2}, {62, 62, 62}});
    settings.boundary = Boundary::open;
    const mesh::Mesh mesh = mesh_of(gyroid, settings);
    EXPECT_EQ(mesh.positions.size() > 65'536, wave < 8) << mesh.positions.size();
    expect_valid(mesh);
    double longest = 0;
    for (const auto& t : mesh.triangles)
      for (int c = 0; c < 3; ++c)
        longest = std::max(
            longest, length(to_double(mesh.positions[t[c]]) - to_double(mesh.positions[t[(c + 1) % 3]])));
    EXPECT_GT(longest, 0.5);
    EXPECT_LE(longest, std::sqrt(3.0));
  }
}

TEST(Polygonize, SphereConvergesWithSecondOrder) {
  double area_error[2], volume_error[2], normal_error[2];
  for (int level = 0; level < 2; ++level) {
    const Vec3d center{0.3, -0.2, 0.1};
    const mesh::Mesh mesh = mesh_of(sphere(center, 10), solid(level ? 0.5 : 1.0, cube(12)));
    expect_closed(mesh);
    const mesh::MeshMetrics m = mesh::metrics(mesh);
    EXPECT_EQ(m.genus, 0);
    area_error[level] = std::abs(m.area - 4 * pi * 100);
    volume_error[level] = std::abs(m.volume - 4 * pi * 1000 / 3);
    normal_error[level] = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3d out = normalized(to_double(mesh.positions[v]) - center);
      normal_error[level] = std::max(normal_error[level], length(out - to_double(mesh.normals[v])));
    }
  }
  EXPECT_LT(area_error[1], 0.3 * area_error[0]);
  EXPECT_LT(volume_error[1], 0.3 * volume_error[0]);
  EXPECT_LT(area_error[1], 0.005 * 4 * pi * 100);
  EXPECT_LT(volume_error[1], 0.005 * 4 * pi * 1000 / 3);
  EXPECT_LT(normal_error[1], 1e-3);
}

TEST(Polygonize, TorusAcrossChunkCornersHasOneHandle) {
  const mesh::Mesh mesh = mesh_of(torus(40, 15), solid(1.0, cube(60)));
  expect_closed(mesh);
  const mesh::MeshMetrics m = mesh::metrics(mesh);
  EXPECT_EQ(m.components, 1u);
  EXPECT_EQ(m.genus, 1);
  EXPECT_NEAR(m.volume, 2 * pi * pi * 40 * 15 * 15, 0.005 * m.volume);
  EXPECT_NEAR(m.area, 4 * pi * pi * 40 * 15, 0.005 * m.area);
}

TEST(Polygonize, RandomSignsGiveAClosedManifold) {
  // Every case and every pair of adjacent cases occurs in hundreds of thousands of random cells.
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const double share = seed == 0 ? 0.5 : seed == 1 ? 0.3 : 0.75;
    const auto noise = [=](Vec3d p) {
      for (double c : {p.x, p.y, p.z})
        if (std::abs(c) > 34) return -1.0;
      const auto bits = [](double v) { return round_to<std::uint64_t>(v); };
      Random random(seed, hash_combine(bits(p.x), hash_combine(bits(p.y), bits(p.z))));
      // Some samples are exactly 0 and some differ by orders of magnitude, to strain vertex placement.
      const double size = random.below(10) == 0 ? 0 : std::pow(10.0, random.uniform(-6, 1));
      return random.uniform() < share ? size : -size;
    };
    PolygonizeSettings settings = solid(1.0, cube(36));
    settings.normals = false;
    const mesh::Mesh mesh = mesh_of(noise, settings);
    EXPECT_GT(mesh.triangles.size(), 300000u);
    expect_closed(mesh);
  }
}

TEST(Polygonize, ThreadsAndTilesGiveTheSameBytes) {
  const auto gyroid = [](Vec3d p) {
    const Vec3d q = p * 0.13;
    return std::min(
        std::sin(q.x) * std::cos(q.y) + std::sin(q.y) * std::cos(q.z) + std::sin(q.z) * std::cos(q.x),
        52.0 - length(p));
  };
  PolygonizeSettings settings = solid(1.0, cube(55));
  settings.min_fragment_volume = 30;
  set_thread_count(1);
  const mesh::Mesh one = mesh_of(gyroid, settings);
  EXPECT_THAT(mesh::defects(mesh::validate(one)),
              testing::IsEmpty());  // (normals disagree along the crease with the ball)
  set_thread_count(2);
  for (int tiles : {1, 2, 8}) {
    settings.tiles_x = settings.tiles_y = tiles;
    EXPECT_TRUE(same_bytes(one, mesh_of(gyroid, settings))) << tiles;
  }
  set_thread_count(0);
}

using Corner = std::array<float, 6>;
using Facet = std::array<Corner, 3>;

/// Triangles by value, in any order, each beginning with its least corner.
std::multiset<Facet> facets(const mesh::Mesh& mesh) {
  std::multiset<Facet> out;
  for (const auto& t : mesh.triangles) {
    Facet f;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f p = mesh.positions[t[c]], n = mesh.normals[t[c]];
      f[c] = {p.x, p.y, p.z, n.x, n.y, n.z};
    }
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    out.insert(f);
  }
  return out;
}

TEST(Polygonize, TilesHoldTheSameTrianglesAndMeetExactly) {
  const auto f = [](Vec3d p) {
    return std::max(20 * std::sin(p.x * 0.05) * std::cos(p.y * 0.04) - p.z,
                    3 - length(p - Vec3d{64, 64, 50}));
  };
  for (double least : {0.0, 500.0}) {
    PolygonizeSettings settings = solid(2.0, {{-250, -250, -60}, {250, 250, 60}});
    settings.min_fragment_volume = least;
    const auto whole = facets(mesh_of(f, settings));
    settings.tiles_x = 3, settings.tiles_y = 2;
    std::multiset<Facet> parts;
    int tiles = 0;
    PolygonizeStats stats;
    polygonize_tiles(
        test::analytic(f, 2.0, settings.region), settings.region, settings,
        [&](TileIndex, mesh::Mesh&& mesh) {
          ++tiles;
          EXPECT_THAT(mesh::defects(mesh::validate(mesh)), testing::IsEmpty());
          parts.merge(facets(mesh));
        },
        silent(), &stats);
    EXPECT_EQ(tiles, 6);
    EXPECT_TRUE(parts == whole);
    EXPECT_EQ(stats.fragments_removed, least > 0 ? 1u : 0u);
  }
}

TEST(Polygonize, RemovesFragmentsWholeAndKeepsLargeOnes) {
  const auto base = sphere({0, 0, -40}, 30);
  const auto ball = sphere({64, 64, 64}, 2.3);   // around a chunk corner
  const auto bubble = sphere({3, 0, -40}, 2.0);  // a void inside the base
  const auto bridge = [](Vec3d p) {              // thin, across three chunks
    return 1.2 - std::hypot(std::max(std::abs(p.x) - 90, 0.0), std::hypot(p.y - 20, p.z - 20));
  };
  const auto f = [=](Vec3d p) { return std::max({std::min(base(p), -bubble(p)), ball(p), bridge(p)}); };
  PolygonizeSettings settings = solid(0.8, cube(110));
  settings.min_fragment_volume = 100;  // ball: 51, bubble: 34, bridge: 814 cubic metres
  PolygonizeStats stats;
  const mesh::Mesh mesh = mesh_of(f, settings, &stats);
  expect_closed(mesh);
  EXPECT_EQ(stats.components, 4u);
  EXPECT_EQ(stats.fragments_removed, 1u);
  EXPECT_EQ(stats.bubbles_removed, 1u);
  EXPECT_EQ(mesh::metrics(mesh).components, 2u);
  const double expected = 4 * pi * 27000 / 3 + pi * 1.44 * 180;
  EXPECT_NEAR(mesh::metrics(mesh).volume, expected, 0.01 * expected);
}

/// A ball whose relief is finer than a cell, and a blade with an acute edge: gradients on neighbouring edges
/// of the lattice have little to do with each other.
double rough_ball(Vec3d p) {
  const double relief = 0.8 * std::sin(5.1 * p.x) * std::sin(4.7 * p.y + 1) * std::sin(5.3 * p.z + 2);
  const double blade = std::min({p.z - 0.3 * p.x, 0.4 * p.x - p.z, 90 - length(p)});
  return std::max(70 - length(p) + relief, blade);
}

TEST(Polygonize, NormalsAgreeWithTrianglesWhereTheFieldIsFinerThanACell) {
  PolygonizeSettings settings = solid(1.5, cube(100));
  const mesh::Mesh mesh = mesh_of(rough_ball, settings);
  const mesh::MeshReport report = mesh::validate(mesh);
  EXPECT_THAT(mesh::defects(report), testing::IsEmpty());
  EXPECT_LE(report.flipped_normals, mesh.triangles.size() / 2000);
  // The field's own gradient would not do.
  std::uint64_t flipped = 0;
  for (const auto& t : mesh.triangles) {
    Vec3d mean;
    for (auto v : t) {
      const Vec3d p = to_double(mesh.positions[v]);
      const auto slope = [&](Vec3d e) { return rough_ball(p + e) - rough_ball(p - e); };
      mean -= normalized(Vec3d{slope({1e-4, 0, 0}), slope({0, 1e-4, 0}), slope({0, 0, 1e-4})});
    }
    const Vec3f a = mesh.positions[t[0]];
    flipped += dot(to_double(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)), mean) < 0;
  }
  EXPECT_GT(flipped, 10 * report.flipped_normals + 100);
}

TEST(Polygonize, NormalsAreTheSameOnBothSidesOfEverySeam) {
  for (double least : {0.0, 5.0}) {
    PolygonizeSettings settings = solid(1.5, cube(150));
    settings.min_fragment_volume = least;
    const mesh::Mesh whole = mesh_of(rough_ball, settings);
    std::map<std::array<float, 3>, Vec3f> normals;
    for (std::size_t v = 0; v < whole.positions.size(); ++v)
      normals[{whole.positions[v].x, whole.positions[v].y, whole.positions[v].z}] = whole.normals[v];
    settings.tiles_x = 3, settings.tiles_y = 2;
    std::size_t vertices = 0, others = 0;
    polygonize_tiles(test::analytic(rough_ball, settings.voxel, settings.region), settings.region, settings,
                     [&](TileIndex, mesh::Mesh&& tile) {
                       for (std::size_t v = 0; v < tile.positions.size(); ++v) {
                         const Vec3f p = tile.positions[v];
                         others += !(normals.at({p.x, p.y, p.z}) == tile.normals[v]);
                       }
                       vertices += tile.positions.size();
                     });
    EXPECT_GT(vertices, whole.positions.size());
    EXPECT_EQ(others, 0u);
  }
}

TEST(Polygonize, OpenBorderIsACleanLatticeLine) {
  PolygonizeSettings settings = solid(1.0, {{-70.2, -50.7, -20}, {69.9, 50.3, 20}});
  settings.boundary = Boundary::open;
  const auto f = [](Vec3d p) { return 3 * std::sin(p.x * 0.2) - p.z + 0.37; };
  settings.inside = [](double x, double y) {
    return std::hypot(x, y) > 12 && std::fmod(std::abs(x * 3 + y * 7), 5.0) > 0.4;
  };
  const mesh::Mesh mesh = mesh_of(f, settings);
  expect_valid(mesh);
  EXPECT_GT(mesh::validate(mesh).boundary_edges, 500u);
  for (const Vec3f& p : mesh.positions) {
    EXPECT_LE(std::abs(p.x), 71.0f);
    EXPECT_GE(std::hypot(p.x, p.y), 11.0f);
  }
  settings.inside = nullptr;
  const mesh::Mesh sheet = mesh_of(f, settings);
  expect_valid(sheet);
  EXPECT_EQ(mesh::metrics(sheet).boundary_loops, 1u);
  // Cells whose centre lies in the region: from -70 to 70 and from -51 to 50.
  const Box3d bounds = mesh::metrics(sheet).bounds;
  EXPECT_EQ(bounds.lo.x, -70);
  EXPECT_EQ(bounds.hi.x, 70);
  EXPECT_EQ(bounds.lo.y, -51);
  EXPECT_EQ(bounds.hi.y, 50);
}

TEST(Polygonize, FragmentsThatReachAnOpenBorderStay) {
  PolygonizeSettings settings = solid(1.0, {{-30, -30, -30}, {30, 30, 30}});
  settings.boundary = Boundary::open;
  settings.min_fragment_volume = 1e6;
  const auto f = [](Vec3d p) { return std::max(-p.z - 10.3, 4 - length(p - Vec3d{30, 0, 12})); };
  PolygonizeStats stats;
  const mesh::Mesh mesh = mesh_of(f, settings, &stats);
  expect_valid(mesh);
  EXPECT_EQ(stats.components, 2u);
  EXPECT_EQ(stats.fragments_removed, 0u);
}

TEST(Polygonize, NothingAndEverythingGiveAnEmptyMesh) {
  for (double value : {-1.0, 0.0, 1.0}) {
    const mesh::Mesh mesh = mesh_of([=](Vec3d) { return value; }, solid(1.0, cube(20)));
    EXPECT_TRUE(mesh.positions.empty());
    EXPECT_TRUE(mesh.triangles.empty());
  }
  EXPECT_TRUE(mesh_of(sphere({}, 1), solid(1.0, {})).triangles.empty());
}

TEST(Polygonize, KeepsVerticesApartFarFromTheOrigin) {
  const Vec3d center{2.1e6 + 0.37, -1.3e6, 12};
  const mesh::Mesh mesh = mesh_of(
      sphere(center, 150), solid(16.0, {center - Vec3d{170, 170, 170}, center + Vec3d{170, 170, 170}}));
  EXPECT_GT(mesh.triangles.size(), 500u);
  expect_closed(mesh);
  EXPECT_THAT(error_of([&] {
                mesh_of(sphere({4e6, 0, 0}, 10), solid(0.01, {{4e6 - 12, -12, -12}, {4e6 + 12, 12, 12}}));
              }),
              ::testing::HasSubstr("too far for single precision"));
}

TEST(Polygonize, RefusesWhatCannotBe) {
  EXPECT_THAT(error_of([&] { mesh_of(sphere({}, 1), solid(0, cube(2))); }),
              ::testing::HasSubstr("a voxel of 0 m cannot be used"));
  EXPECT_THAT(error_of([&] { mesh_of(sphere({}, 1), solid(std::nan(""), cube(2))); }),
              ::testing::HasSubstr("a voxel of nan m cannot be used"));
  EXPECT_THAT(error_of([&] { mesh_of(sphere({}, 1), solid(1, cube(1e300))); }),
              ::testing::HasSubstr("has no end or is too large for a voxel of 1 m"));
  PolygonizeSettings settings = solid(1, cube(2));
  settings.tiles_x = 0;
  EXPECT_THAT(error_of([&] { mesh_of(sphere({}, 1), settings); }),
              ::testing::HasSubstr("0 x 1 tiles cannot be made"));
}

TEST(Polygonize, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  const PolygonizeSettings settings = solid(1, cube(80));
  EXPECT_THAT(error_of([&] {
                polygonize(test::analytic(sphere({}, 50), 1, settings.region), settings.region, settings,
                           progress);
              }),
              ::testing::HasSubstr("cancelled"));
}

}  // namespace
}  // namespace tafoni::surface
