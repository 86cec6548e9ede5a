#include "tafoni/surface/grid_mesher.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/rounds.h"
#include "tafoni/math/draw.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/surface/dense_grid.h"
#include "tafoni/volume/edit.h"

namespace tafoni::surface {
namespace {

using volume::Edit;
using volume::GridFrame;
using volume::Precision;
using volume::SampleBox;
using volume::ScalarGrid;
using volume::Tool;

constexpr double amplitude = 4;

/// A rough ground with tunnels, saturated.
ScalarGrid ground(const GridFrame& frame, Precision precision = Precision::single) {
  ScalarGrid grid(frame, 0, precision);
  const double middle = (frame.box().lo.z + frame.box().hi.z) / 2;
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (int i = 0; i < std::ssize(row); ++i) {
      const Vec3d p = frame.position(first + Vec3i{i, 0, 0});
      const double hill = middle + 3 * std::sin(0.21 * p.x) * std::cos(0.17 * p.y) - p.z;
      const double caves =
          5 * (std::sin(0.3 * p.x) * std::cos(0.27 * p.y) + std::sin(0.25 * p.y + 0.3 * p.z));
      row[i] = static_cast<float>(std::clamp(std::min(hill, caves + 4), -amplitude, amplitude));
    }
  });
  grid.compact();
  return grid;
}

bool same(const GridChunkMesh& a, const GridChunkMesh& b) {
  const auto equal = [](const auto& u, const auto& v) {
    return u.size() == v.size() &&
           (u.empty() || std::memcmp(u.data(), v.data(), u.size() * sizeof(u[0])) == 0);
  };
  return equal(a.positions, b.positions) && equal(a.normals, b.normals) && equal(a.triangles, b.triangles) &&
         equal(a.polygons.voxels, b.polygons.voxels) && equal(a.polygons.first, b.polygons.first) &&
         equal(a.polygons.begin, b.polygons.begin) && equal(a.polygons.corners, b.polygons.corners);
}

void expect_equal_to_full(const GridMesher& mesher, const ScalarGrid& grid,
                          const GridMesherSettings& settings) {
  GridMesher full(settings);
  full.update(grid, {});
  ASSERT_EQ(mesher.chunks(), full.chunks());
  for (Vec3i at : full.chunks()) ASSERT_TRUE(same(*mesher.chunk(at), *full.chunk(at)));
}

using Corner = std::array<float, 6>;

/// Every triangle as its corners' positions and normals, from the least corner on; sorted.
std::vector<std::array<Corner, 3>> triangle_set(const mesh::Mesh& m) {
  std::vector<std::array<Corner, 3>> out;
  for (const auto& t : m.triangles) {
    std::array<Corner, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f p = m.positions[t[c]], n = m.normals[t[c]];
      corners[c] = {p.x, p.y, p.z, n.x, n.y, n.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.push_back(corners);
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(GridMesher, TheAssembledMeshIsThatOfTheDenseGrid) {
  for (const Vec3i size : {Vec3i{97, 70, 65}, Vec3i{33, 34, 20}, Vec3i{12, 66, 32}}) {
    const GridFrame frame{{}, 0.75, size};
    const ScalarGrid grid = ground(frame);
    std::vector<float> samples(sample_count(size));
    grid.read(grid.samples(), samples.data());
    mesh::Mesh dense;
    polygonize_grid({samples.data(), size.x, size.y, size.z, frame.spacing}, true, dense);
    GridMesher mesher;
    mesher.update(grid, {});
    const mesh::Mesh mesh = mesher.assemble();
    EXPECT_EQ(mesh.positions.size(), dense.positions.size());
    EXPECT_EQ(triangle_set(mesh), triangle_set(dense));
    EXPECT_TRUE(mesh::validate(mesh).valid());
  }
}

TEST(GridMesher, NeighboursRepeatSharedVerticesBitForBit) {
  const GridFrame frame{{1000.3, -77.7, 12.1}, 0.37, {100, 100, 64}};
  const ScalarGrid grid = ground(frame);
  GridMesher mesher;
  mesher.update(grid, {});
  std::set<Corner> all;
  std::size_t repeated = 0;
  for (Vec3i at : mesher.chunks()) {
    const GridChunkPtr chunk = mesher.chunk(at);
    for (std::size_t v = 0; v < chunk->positions.size(); ++v) {
      const Vec3f p = chunk->positions[v], n = chunk->normals[v];
      repeated += !all.insert({p.x, p.y, p.z, n.x, n.y, n.z}).second;
    }
  }
  EXPECT_GT(repeated, 100u);
  const mesh::Mesh mesh = mesher.assemble();
  EXPECT_EQ(all.size(), mesh.positions.size());
  EXPECT_TRUE(mesh::validate(mesh).valid());
}

/// Tools, explosions and single samples, many at chunk borders and over the frame's border.
SampleBox edit_at_random(ScalarGrid& grid, Random& random) {
  const Box3d box = grid.frame().box().grown(3);
  const double h = grid.frame().spacing;
  const auto within = [&](double lo, double hi) {
    // Every other time near a border of chunks.
    const double v = random.uniform(lo, hi);
    return random.below(2) ? v : lo + 3 + 32 * h * std::round((v - lo - 3) / (32 * h));
  };
  const Vec3d p{within(box.lo.x, box.hi.x), within(box.lo.y, box.hi.y), within(box.lo.z, box.hi.z)};
  const double r = random.uniform(0.5, 6);
  const Edit edit = random.below(2) ? Edit::add : Edit::remove;
  switch (random.below(6)) {
    case 0:
      return explode(grid, p, r, random.uniform(-8, 8), amplitude);
    case 1:
      return apply(grid, Tool::box(p, {r, 0.5 * r, 0.7 * r}, r), edit, amplitude);
    case 2:
      return apply(grid, Tool::capsule(p, p + Vec3d{r, -r, 0.4 * r}, 0.4 * r), edit, amplitude);
    case 3: {
      const SampleBox near = grid.samples_in({p, p});
      return grid.edit(near, [&](Vec3i, std::span<float> row) {
        for (float& v : row) v = draw_float(random, -amplitude, amplitude);
      });
    }
    default:
      return apply(grid, Tool::sphere(p, r), edit, amplitude);
  }
}

/// Thousands of edits; every twentieth time all chunks are compared with a mesh made from nothing.
void expect_local_equals_full(Precision precision, const GridMesherSettings& settings) {
  ScalarGrid grid = ground({{-7.3, 12.9, -4.4}, 0.6, {68, 40, 36}}, precision);
  GridMesher mesher(settings);
  mesher.update(grid, {});
  Random random(11, precision);
  std::map<std::array<int, 3>, GridChunkPtr> held;
  const auto key = [](Vec3i c) { return std::array{c.x, c.y, c.z}; };
  for (Vec3i at : mesher.chunks()) held[key(at)] = mesher.chunk(at);
  for (int step = 0; step < rounds(5000); ++step) {
    std::vector<SampleBox> boxes;
    for (std::uint64_t n = 0; n <= random.below(2); ++n) boxes.push_back(edit_at_random(grid, random));
    for (const auto& change : mesher.update(grid, boxes)) {
      const GridChunkPtr now = mesher.chunk(change.chunk);
      GridChunkPtr& was = held[key(change.chunk)];
      ASSERT_TRUE(!was || !same(*was, *now));
      if (!now->triangles.empty()) {
        ASSERT_EQ(change.version, now->version);
      }
      was = now;
    }
    if (step % 20 == 19) {
      expect_equal_to_full(mesher, grid, settings);
      if (testing::Test::HasFatalFailure()) return;
      for (const auto& [at, mesh] : held)
        ASSERT_TRUE(same(*mesh, *mesher.chunk({at[0], at[1], at[2]})));  // nothing changed unannounced
    }
  }
}

TEST(GridMesher, LocalRepolygonizationEqualsFull) {
  expect_local_equals_full(Precision::single, {Boundary::open, false});
}

TEST(GridMesher, LocalRepolygonizationEqualsFullOfSolidsWithPolygonsInHalfPrecision) {
  expect_local_equals_full(Precision::half, {Boundary::solid, true});
}

TEST(GridMesher, ASolidIsClosedWhateverIsDug) {
  ScalarGrid grid = ground({{3, 4, 5}, 0.8, {70, 40, 45}});
  GridMesher mesher({Boundary::solid, false});
  mesher.update(grid, {});
  Random random(5);
  for (int step = 0; step < 60; ++step) {
    const mesh::MeshReport report = mesh::validate(mesher.assemble());
    ASSERT_TRUE(report.valid());
    ASSERT_TRUE(report.closed());
    const SampleBox changed = edit_at_random(grid, random);
    mesher.update(grid, {&changed, 1});
  }
}

TEST(GridMesher, ABlockOfRockHasWallsAroundItsFrame) {
  for (int n : {33, 40, 65}) {
    const GridFrame frame{{-5, 2, 100}, 0.5, {n, n, n}};
    GridMesher mesher({Boundary::solid, false});
    mesher.update(ScalarGrid(frame, 3), {});
    const mesh::Mesh mesh = mesher.assemble();
    const mesh::MeshReport report = mesh::validate(mesh);
    EXPECT_TRUE(report.valid() && report.closed());
    EXPECT_EQ(report.components, 1u);
    const double side = 0.5 * (n - 1 + 2.0 / 128);
    EXPECT_NEAR(mesh::metrics(mesh).volume, side * side * side, 0.002 * side * side);
    for (Vec3f normal : mesh.normals)
      EXPECT_EQ(std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z), 1);
  }
}

TEST(GridMesher, ASphereHasItsVolumeAndNormals) {
  const GridFrame frame{{-20, -20, -20}, 0.5, {81, 81, 81}};
  ScalarGrid grid(frame, -4);
  const Tool ball = Tool::sphere({0.3, -0.2, 0.4}, 15);
  const SampleBox changed = apply(grid, ball, Edit::add, amplitude);
  GridMesher mesher({Boundary::solid, false});
  mesher.update(ScalarGrid(frame, -4), {});
  EXPECT_TRUE(mesher.chunks().empty());
  const std::size_t changes = mesher.update(grid, {&changed, 1}).size();
  EXPECT_EQ(changes, mesher.chunks().size());
  const mesh::Mesh mesh = mesher.assemble();
  EXPECT_NEAR(mesh::metrics(mesh).volume, 4.0 / 3 * 3.14159265 * 15 * 15 * 15, 15);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d d = to_double(mesh.positions[v]) - Vec3d{0.3, -0.2, 0.4};
    EXPECT_NEAR(length(d), 15, 5e-3);
    EXPECT_GT(dot(normalized(d), to_double(mesh.normals[v])), 0.999);
  }
}

/// Convex and planar within `tolerance`, as the header says.
bool good_polygon(const std::vector<Vec3d>& p, double tolerance) {
  Vec3d area, middle;
  for (std::size_t i = 0; i < p.size(); ++i) {
    area += cross(p[i] - p[0], p[(i + 1) % p.size()] - p[0]);
    middle += p[i] * (1.0 / static_cast<double>(p.size()));
  }
  const Vec3d normal = normalized(area);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (std::abs(dot(p[i] - middle, normal)) > tolerance) return false;
    // Each corner lies left of each side.
    for (Vec3d corner : p)
      if (dot(cross(p[(i + 1) % p.size()] - p[i], corner - p[i]), normal) < -1e-9) return false;
  }
  return true;
}

double area_of(const std::vector<Vec3d>& p) {
  Vec3d area;
  for (std::size_t i = 0; i < p.size(); ++i) area += cross(p[i] - p[0], p[(i + 1) % p.size()] - p[0]);
  return length(area) / 2;
}

TEST(GridMesher, PolygonsAreConvexPlanarAndCoverTheTriangles) {
  ScalarGrid grid = ground({{}, 0.7, {70, 66, 50}});
  apply(grid, Tool::box({20, 20, 15}, {9, 7, 12}, 0.3), Edit::remove, amplitude);
  GridMesher mesher({Boundary::solid, true});
  mesher.update(grid, {});
  std::size_t larger = 0;
  for (Vec3i at : mesher.chunks()) {
    const GridChunkPtr chunk = mesher.chunk(at);
    const VoxelPolygons& polygons = chunk->polygons;
    double area = 0, triangles = 0;
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
      std::vector<Vec3d> corners;
      const auto polygon = polygons.polygon(p);
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        corners.push_back(to_double(chunk->positions[polygon[i]]));
        sides.insert({polygon[i], polygon[(i + 1) % polygon.size()]});
      }
      area += area_of(corners);
      if (corners.size() == 3) continue;
      ASSERT_TRUE(good_polygon(corners, 0.7 / 256 * 1.001));
      ++larger;
    }
    for (const auto& t : chunk->triangles)
      triangles += area_of({to_double(chunk->positions[t[0]]), to_double(chunk->positions[t[1]]),
                            to_double(chunk->positions[t[2]])});
    EXPECT_NEAR(area, triangles, 0.01 * triangles);
    // Sides are sides of triangles, and what triangles do not share polygons do not either.
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> of_triangles;
    for (const auto& t : chunk->triangles)
      for (std::size_t i = 0; i < 3; ++i) of_triangles.insert({t[i], t[(i + 1) % 3]});
    const auto open = [](const auto& all) {
      auto out = all;
      for (const auto& [a, b] : all)
        if (all.contains({b, a})) out.erase({a, b});
      return out;
    };
    EXPECT_TRUE(std::includes(of_triangles.begin(), of_triangles.end(), sides.begin(), sides.end()));
    EXPECT_EQ(open(sides), open(of_triangles));
  }
  EXPECT_GT(larger, 1000u);
}

TEST(GridMesher, PolygonsOfAVoxelLieInIt) {
  const GridFrame frame{{2, 3, 4}, 0.5, {50, 40, 40}};
  const ScalarGrid grid = ground(frame);
  GridMesher mesher({Boundary::open, true});
  mesher.update(grid, {});
  for (Vec3i at : mesher.chunks()) {
    const GridChunkPtr chunk = mesher.chunk(at);
    const auto& polygons = chunk->polygons;
    ASSERT_FALSE(polygons.voxels.empty());
    for (std::size_t v = 0; v < polygons.voxels.size(); ++v) {
      const Vec3i voxel = polygons.voxels[v];
      const auto [first, last] = polygons.of(voxel);
      ASSERT_EQ(first, polygons.first[v]);
      ASSERT_LT(first, last);
      const Box3d box = Box3d{frame.position(voxel), frame.position(voxel + Vec3i{1, 1, 1})}.grown(1e-5);
      for (std::uint32_t p = first; p < last; ++p)
        for (std::uint32_t corner : polygons.polygon(p))
          ASSERT_TRUE(box.contains(to_double(chunk->positions[corner])));
    }
    EXPECT_EQ(polygons.of({-1, 0, 0}), (std::pair<std::uint32_t, std::uint32_t>{0, 0}));
  }
}

TEST(GridMesher, AFlatSurfaceHasOnePolygonAVoxel) {
  const GridFrame frame{{}, 1, {40, 40, 40}};
  ScalarGrid grid(frame, 0);
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (int i = 0; i < std::ssize(row); ++i)
      row[i] = static_cast<float>(18.3 + 0.31 * (first.x + i) - 0.17 * first.y - first.z);
  });
  GridMesher mesher({Boundary::open, true});
  mesher.update(grid, {});
  for (Vec3i at : mesher.chunks()) {
    const GridChunkPtr chunk = mesher.chunk(at);
    EXPECT_EQ(chunk->polygons.size(), chunk->polygons.voxels.size());
    EXPECT_GT(chunk->triangles.size(), chunk->polygons.size());
  }
}

TEST(GridMesher, HeldMeshesStayAsTheyWere) {
  ScalarGrid grid = ground({{}, 1, {64, 64, 64}});
  GridMesher mesher;
  mesher.update(grid, {});
  const Vec3i at = mesher.chunks().front();
  const GridChunkPtr before = mesher.chunk(at);
  const GridChunkMesh copy = *before;
  const SampleBox changed = apply(grid, Tool::box({32, 32, 32}, {40, 40, 40}), Edit::remove, amplitude);
  const auto changes = mesher.update(grid, {&changed, 1});
  EXPECT_TRUE(same(*before, copy));
  EXPECT_EQ(before->version, 1u);
  // All rock is gone, and every chunk that had some says so.
  EXPECT_TRUE(mesher.chunks().empty());
  EXPECT_TRUE(mesher.chunk(at)->triangles.empty());
  EXPECT_NE(std::find(changes.begin(), changes.end(), ChunkChange{at, 2}), changes.end());
  EXPECT_TRUE(mesher.assemble().triangles.empty());
}

TEST(GridMesher, AnUpdateWithoutChangesAnnouncesNone) {
  ScalarGrid grid = ground({{}, 1, {64, 64, 64}});
  GridMesher mesher;
  EXPECT_FALSE(mesher.update(grid, {}).empty());
  const SampleBox all = grid.samples(), none;
  EXPECT_TRUE(mesher.update(grid, {&all, 1}).empty());
  EXPECT_TRUE(mesher.update(grid, {&none, 1}).empty());
  EXPECT_TRUE(mesher.update(grid, {}).empty());
}

TEST(GridMesher, AfterACancelEverythingIsLookedAt) {
  ScalarGrid grid = ground({{}, 1, {64, 64, 64}});
  GridMesher mesher;
  mesher.update(grid, {});
  const SampleBox changed = apply(grid, Tool::sphere({32, 32, 32}, 9), Edit::remove, amplitude);
  Progress cancelled;
  cancelled.cancel();
  EXPECT_THAT(error_of([&] {
                mesher.update(grid, {&changed, 1}, cancelled);
              }),
              ::testing::HasSubstr("cancelled"));
  EXPECT_THAT(error_of([&] { mesher.assemble(); }),
              ::testing::HasSubstr("cannot be assembled before an update()"));
  mesher.update(grid, {});
  expect_equal_to_full(mesher, grid, {});
}

TEST(GridMesher, AnotherFrameBeginsAnew) {
  const ScalarGrid large = ground({{}, 1, {100, 64, 64}}), small = ground({{5, 5, 5}, 1, {50, 60, 40}});
  GridMesher mesher;
  mesher.update(large, {});
  const auto changes = mesher.update(small, {});
  expect_equal_to_full(mesher, small, {});
  EXPECT_NE(std::find_if(changes.begin(), changes.end(), [](const auto& c) { return c.chunk.x == 2; }),
            changes.end());
}

TEST(GridMesher, RefusesFramesTooFarFromZero) {
  GridMesher mesher;
  EXPECT_THAT(error_of([&] {
                mesher.update(ScalarGrid({{5e6, 0, 0}, 0.1, {8, 8, 8}}, 1), {});
              }),
              ::testing::HasSubstr("too far for single precision"));
}

}  // namespace
}  // namespace tafoni::surface
