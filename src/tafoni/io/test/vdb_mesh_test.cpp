// What OpenVDB's own tools make of the level sets that we write: closed meshes of the same volume as ours,
// whatever the field is like; and the same bytes each time.

#include "tafoni/core/error.h"
#include "tafoni/io/test/volumes.h"

#ifdef TAFONI_OPENVDB

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include <gmock/gmock.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "tafoni/core/parallel.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/surface/distances.h"
#include "tafoni/surface/grid_mesher.h"
#include "tafoni/volume/test/grid_of.h"

namespace tafoni::io {
namespace {

using openvdb::FloatGrid;
using volume::grid_of;
using volume::GridFrame;
using volume::Precision;
using volume::ScalarGrid;

class VdbMesh : public VolumeFiles {
 protected:
  /// Written and read by OpenVDB.
  FloatGrid::Ptr there(const ScalarGrid& grid) const {
    write_volume(path("a.vdb"), {grid, {452300.5, 5528100.25, 120}, {}});
    openvdb::initialize();
    openvdb::io::File file(path("a.vdb").string());
    file.open();
    const auto out = openvdb::gridPtrCast<FloatGrid>(file.readGrid("surface"));
    file.close();
    return out;
  }
};

struct VdbMeshed {
  std::size_t quads = 0, open_edges = 0;
  double volume = 0;
};

/// OpenVDB's mesh at 0. An edge is open when one polygon has it.
VdbMeshed meshed(const FloatGrid& grid) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, 0.0, 0.0);
  VdbMeshed out{quads.size(), 0, 0};
  std::map<std::pair<openvdb::Index32, openvdb::Index32>, int> edges;
  const auto add = [&](const auto& polygon, int n) {
    for (int i = 0; i < n; ++i) {
      const openvdb::Index32 a = polygon[i], b = polygon[(i + 1) % n];
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
    for (int i = 2; i < n; ++i)
      out.volume +=
          openvdb::Vec3d(points[polygon[0]])
              .dot(openvdb::Vec3d(points[polygon[i - 1]]).cross(openvdb::Vec3d(points[polygon[i]]))) /
          6;
  };
  for (const auto& t : triangles) add(t, 3);
  for (const auto& q : quads) add(q, 4);
  for (const auto& [edge, count] : edges) out.open_edges += count % 2;
  out.volume = std::abs(out.volume);
  return out;
}

/// The mesh that we make of the grid.
mesh::Mesh own_mesh(const ScalarGrid& grid) {
  surface::GridMesher mesher;
  mesher.update(grid, {});
  return mesher.assemble();
}

/// OpenVDB's level set of a mesh in a frame of ours, at the same indices.
FloatGrid::Ptr level_set_of(const mesh::Mesh& mesh, const GridFrame& frame) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3f& p : mesh.positions) {
    const Vec3f at = p - to_float(frame.origin);
    points.emplace_back(at.x, at.y, at.z);
  }
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto cells = openvdb::math::Transform::createLinearTransform(frame.spacing);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
  // Without what it does against bumps, which adds rock at edges.
  return openvdb::tools::meshToVolume<FloatGrid>(adapter, *cells, 3, 3,
                                                 openvdb::tools::DISABLE_RENORMALIZATION);
}

constexpr GridFrame middle{{-40, -30, -20}, 1, {81, 61, 41}};

double box_and_ball(Vec3d p) {
  const Vec3d q{std::abs(p.x + 12) - 18.3, std::abs(p.y) - 15.2, std::abs(p.z) - 11.4};
  return std::max(-std::max({q.x, q.y, q.z}), 13.7 - length(p - Vec3d{12, 3, 1}));
}

TEST_F(VdbMesh, IsClosedWhateverTheFieldIs) {
  Random random(4);
  const std::pair<const char*, std::function<double(Vec3d)>> fields[] = {
      {"all within a step", [](Vec3d p) { return std::clamp(40 * box_and_ball(p), -3.0, 3.0); }},
      {"noise", [&](Vec3d p) { return length(p) < 17 ? std::copysign(3, random.uniform(-1, 1)) : -3.0; }},
      {"shallow", [](Vec3d p) { return 0.1 * box_and_ball(p); }},
      {"cut off by the frame", [](Vec3d p) { return std::clamp(60 - length(p), -3.0, 3.0); }},
      {"rock at every side", [](Vec3d) { return 3.0; }},
      {"beside a chunk's side", [](Vec3d p) { return p.x < -8.5 && p.x > -20 ? 3.0 : -3.0; }},
  };
  for (const auto& [name, f] : fields) {
    const FloatGrid::Ptr grid = there(grid_of(middle, f));
    const VdbMeshed mesh = meshed(*grid);
    EXPECT_GT(mesh.quads, 100u) << name;
    EXPECT_EQ(mesh.open_edges, 0u) << name;
    EXPECT_FALSE(grid->tree().hasActiveTiles()) << name;
  }
}

TEST_F(VdbMesh, OnlyWhatVariesIsActive) {
  // Values that level off at 7.5 m, and a cave where they are beyond that.
  const FloatGrid::Ptr grid = there(grid_of({{0, 0, 0}, 1, {160, 160, 160}}, [](Vec3d p) {
    const double ground = std::clamp(80.3 - p.z, -7.5, 7.5), r = length(p - Vec3d{80, 80, 70});
    return r < 6 ? std::min(ground, 2 * (r - 5) - 10) : ground;
  }));
  EXPECT_GT(grid->background(), 7.5);
  EXPECT_LT(grid->activeVoxelCount(), 160 * 160 * 160 / 4u);
}

TEST_F(VdbMesh, DistancesHaveOurVolume) {
  for (const double steepness : {0.2, 1.0, 30.0}) {
    const ScalarGrid field = grid_of(middle, [&](Vec3d p) { return steepness * box_and_ball(p); });
    const mesh::Mesh mesh_of_field = own_mesh(field);
    const double truth = mesh::metrics(mesh_of_field).volume;
    const double measured = openvdb::tools::levelSetVolume(*level_set_of(mesh_of_field, middle));
    for (const Precision precision : {Precision::single, Precision::half}) {
      const FloatGrid::Ptr grid = there(surface::distances(field, 3.01, precision));
      EXPECT_GE(grid->background(), 3);
      const VdbMeshed mesh = meshed(*grid);
      EXPECT_EQ(mesh.open_edges, 0u);
      EXPECT_NEAR(mesh.volume / truth, 1, 0.002) << steepness;
      // OpenVDB takes a surface for a layer three cells wide, and measures 0.3 % more than the mesh holds;
      // the same of a level set that it makes of the mesh itself.
      EXPECT_NEAR(openvdb::tools::levelSetVolume(*grid) / measured, 1, 0.0005) << steepness;
      EXPECT_NEAR(openvdb::tools::levelSetVolume(*grid) / truth, 1, 0.004) << steepness;
      // Near creases the true distance's slope is not 1 either.
      const std::string said = openvdb::tools::checkLevelSet(*grid, 9);
      EXPECT_TRUE(said.empty() || said.find("NormGrad") != std::string::npos) << said;
    }
  }
}

TEST_F(VdbMesh, DistancesOfASmoothSurfacePassEveryCheck) {
  const ScalarGrid field = grid_of(middle, [](Vec3d p) { return 5 * (15.3 - length(p)); });
  const FloatGrid::Ptr grid = there(surface::distances(field, 4, Precision::single));
  EXPECT_EQ(openvdb::tools::checkLevelSet(*grid, 9), "");
  const mesh::Mesh mesh_of_field = own_mesh(field);
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*grid) / mesh::metrics(mesh_of_field).volume, 1, 0.004);
  const double measured = openvdb::tools::levelSetVolume(*level_set_of(mesh_of_field, middle));
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*grid) / measured, 1, 0.0005);
  // Of its own ball, too, OpenVDB measures more than there is.
  const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(15.3f, {40, 30, 20}, 1, 4);
  EXPECT_GT(openvdb::tools::levelSetVolume(*ball), 1.002 * 4 * std::numbers::pi / 3 * std::pow(15.3, 3));
}

TEST_F(VdbMesh, TheSameVolumeGivesTheSameBytes) {
  const Volume volume = hollow_ball(Precision::single);
  write_volume(path("a.vdb"), volume);
  set_thread_count(1);
  write_volume(path("b.vdb"), volume);
  set_thread_count(0);
  EXPECT_EQ(bytes("a.vdb"), bytes("b.vdb"));
  // Another volume has another identity, by which programs tell that a file has changed.
  write_volume(path("c.vdb"), hollow_ball(Precision::single, {101, 97, 69}));
  constexpr std::size_t identity = 21, letters = 36;
  EXPECT_NE(bytes("a.vdb").substr(identity, letters), bytes("c.vdb").substr(identity, letters));
}

}  // namespace
}  // namespace tafoni::io

#endif
