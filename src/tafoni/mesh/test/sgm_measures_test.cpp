// The measures of [Zawadzki] against solids that are known exactly.

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/field/each_point.h"
#include "tafoni/field/function.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/lattice.h"
#include "tafoni/math/whole.h"
#include "tafoni/mesh/convexity.h"
#include "tafoni/mesh/cubes.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::mesh {
namespace {

constexpr double pi = 3.14159265358979323846;

/// A distance, positive inside.
class Distance final : public field::Function {
 public:
  explicit Distance(double (*d)(Vec3d)) : d_(d) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field::each_point(points, out, d_);
  }
  Interval range(const Box3d& box) const override {
    const double middle = d_(box.center()), way = length(box.size()) / 2 + 1e-3;
    return rounded(middle - way, middle + way);
  }

 private:
  double (*d_)(Vec3d);
};

double sphere(Vec3d p) {
  return 3 - length(p - Vec3d{0.1, 0.2, 0.3});
}
double box(Vec3d p) {
  const Vec3d q{std::abs(p.x) - 3.03, std::abs(p.y) - 2.02, std::abs(p.z) - 1.01};
  const Vec3d out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return -length(out) - std::min(std::max({q.x, q.y, q.z}), 0.0);
}
double cube(Vec3d p) {
  return 2 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}
double torus(Vec3d p) {
  return 1 - std::hypot(std::hypot(p.x, p.y) - 3, p.z);
}

struct Known {
  const char* name;
  double (*distance)(Vec3d);
  double volume, area;
  double shown;  ///< the sum of its areas as seen along x, y and z, both sides of each
};
const Known solids[] = {
    {"sphere", sphere, 4.0 / 3 * pi * 27, 4 * pi * 9, 6 * pi * 9},
    {"box", box, 8 * 3.03 * 2.02 * 1.01, 8 * (3.03 * 2.02 + 2.02 * 1.01 + 1.01 * 3.03),
     8 * (3.03 * 2.02 + 2.02 * 1.01 + 1.01 * 3.03)},
    {"torus", torus, 2 * pi* pi * 3, 4 * pi* pi * 3, (8 * pi + 32) * 3},
};

constexpr Box3d around{{-4.5, -4.5, -4.5}, {4.5, 4.5, 4.5}};

field::CompiledField field_of(const Known& known) {
  return field::compile(field::function(std::make_shared<Distance>(known.distance)));
}

Mesh mesh_of(const Known& known, double voxel) {
  surface::PolygonizeSettings settings;
  settings.voxel = voxel;
  settings.region = around;
  return surface::polygonize(field_of(known), settings);
}

/// The length by which a polygon of marching squares is shorter than a rectangle of these half widths: what
/// its four corners lose. Edges of a polygonized box lose as much of each cross-section.
double cut_corners(double half_x, double half_y, double voxel) {
  const auto value = [&](int i, int j) { return std::min(half_x - i * voxel, half_y - j * voxel); };
  const int n = 3 + floor_to(std::max(half_x, half_y) / voxel);
  double length = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      std::vector<Vec2d> met;
      const auto side = [&](int i0, int j0, int i1, int j1) {
        const double a = value(i0, j0), b = value(i1, j1), t = a / (a - b);
        if ((a > 0) != (b > 0)) met.push_back({(i0 + t * (i1 - i0)) * voxel, (j0 + t * (j1 - j0)) * voxel});
      };
      side(i, j, i + 1, j);
      side(i, j + 1, i + 1, j + 1);
      side(i, j, i, j + 1);
      side(i + 1, j, i + 1, j + 1);
      if (met.size() == 2) length += std::hypot(met[0].x - met[1].x, met[0].y - met[1].y);
    }
  return 4 * (half_x + half_y - length);
}

TEST(Measures, VolumeAndAreaConvergeToTheTruth) {
  for (const Known& known : solids) {
    double last = 1e9;
    for (const double voxel : {0.4, 0.2, 0.1, 0.05}) {
      const MeshMetrics m = metrics(mesh_of(known, voxel));
      const double volume = std::abs(m.volume / known.volume - 1), area = std::abs(m.area / known.area - 1);
      // A chord's error: the square of the cell over that of the radius; 1 m here.
      EXPECT_LT(volume, 0.3 * voxel * voxel) << known.name << voxel;
      // A box's edges are cut off by up to a cell, so that its area converges as the cell does; all but its
      // eight corners is known.
      const double edges = known.distance == box ? 2 * (1.01 * cut_corners(3.03, 2.02, voxel) +
                                                        2.02 * cut_corners(3.03, 1.01, voxel) +
                                                        3.03 * cut_corners(2.02, 1.01, voxel))
                                                 : 0;
      EXPECT_LT(edges / known.area, 0.3 * voxel);
      EXPECT_NEAR(m.area, known.area - edges, 0.3 * voxel * voxel * known.area) << known.name << voxel;
      EXPECT_LT(volume + area, last) << known.name << voxel;
      last = volume + area;
    }
  }
}

/// Of a box about the origin, cubes of a lattice that stands `off` multiples of their edge.
double cubes_of_box(Vec3d half, double edge, Vec3d off) {
  const auto along = [&](double h, double o) {
    return std::ceil(h / edge - o) - std::floor(-h / edge - o) - 2;  // between the outermost samples inside
  };
  return along(half.x, off.x) * along(half.y, off.y) * along(half.z, off.z);
}

/// Twelve triangles.
Mesh plain_box(Vec3d lo, Vec3d hi) {
  Mesh out;
  for (int c = 0; c < 8; ++c)
    out.positions.push_back(to_float({c & 1 ? hi.x : lo.x, c >> 1 & 1 ? hi.y : lo.y, c >> 2 ? hi.z : lo.z}));
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return out;
}

TEST(Measures, CubesInsideMissHalfACubeOfWhatTheSurfaceShows) {
  for (const Known& known : solids)
    for (const double edge : {0.25, 0.1, 0.05}) {
      const Cubes cubes = inside_cubes(field_of(known), around, edge);
      EXPECT_EQ(cubes.volume(), static_cast<double>(cubes.count) * edge * edge * edge);
      const Cubes counted = inside_cubes(mesh_of(known, 0.05), edge);
      if (known.distance != box) {
        // Centres lie as far inside as cubes reach along the normal; 10 % for how few the cubes are.
        const double missing = 0.5 * edge * known.shown;
        EXPECT_NEAR(known.volume - cubes.volume(), missing, 0.1 * missing) << known.name << edge;
        EXPECT_NEAR(known.volume - counted.volume(), missing, 0.1 * missing) << known.name << edge;
        continue;
      }
      // A level face may lie just before or just behind a whole layer of samples, but that is known.
      const Vec3d half{3.03, 2.02, 1.01}, off{0.3819660113, 0.4142135624, 0.2360679775};
      EXPECT_EQ(static_cast<double>(cubes.count), cubes_of_box(half, edge, {}));
      EXPECT_EQ(static_cast<double>(inside_cubes(plain_box(-half, half), edge).count),
                cubes_of_box(half, edge, off));
    }
}

TEST(Measures, CubesAreThoseWithEightCornersInside) {
  const field::CompiledField field = field_of(solids[2]);
  constexpr double edge = 0.3;
  std::uint64_t count = 0;
  for (int i = -16; i < 16; ++i)
    for (int j = -16; j < 16; ++j)
      for (int k = -16; k < 16; ++k) {
        bool all = true;
        for (int c = 0; c < 8; ++c)
          all &= field.value({edge * (i + (c & 1)), edge * (j + (c >> 1 & 1)), edge * (k + (c >> 2))}) > 0;
        count += all;
      }
  EXPECT_EQ(inside_cubes(field, around, edge).count, count);
}

TEST(Measures, ACubeIsConvexAndItsHollowIsNot) {
  // Faces on the lattice, and half a cell off it. Elsewhere the corners of a polygonized box are dented a
  // little, since samples beside a corner are nearer to another face than the one that is crossed.
  for (const double voxel : {0.2, 0.16})
    EXPECT_EQ(convexity(mesh_of({"", cube, 0, 0, 0}, voxel)).factor(), 100);
  EXPECT_GT(convexity(mesh_of(solids[1], 0.2)).factor(), 95);
  // Twelve triangles: twelve edges bent, six diagonals flat.
  Mesh plain = plain_box({0, 0, 0}, {1, 1, 1});
  EXPECT_NEAR(metrics(plain).volume, 1, 1e-12);
  const Convexity edges = convexity(plain);
  EXPECT_EQ(edges.convex, 12u);
  EXPECT_EQ(edges.concave, 0u);
  EXPECT_EQ(edges.flat, 6u);
  EXPECT_EQ(edges.factor(), 100);
  for (auto& t : plain.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(convexity(plain).factor(), 0);
}

TEST(Measures, CubesTooSmallForAMeshAreRefused) {
  EXPECT_THAT(error_of([&] {
                inside_cubes(plain_box({0, 0, 0}, {100, 100, 1}), 1e-3);
              }),
              ::testing::HasSubstr("cubes of 0.001 m are too small for the mesh"));
  EXPECT_THAT(error_of([&] {
                inside_cubes(plain_box({0, 0, 0}, {100, 0.01, 100}), 1e-3);
              }),
              ::testing::HasSubstr("cubes of 0.001 m are too small for the mesh"));
}

TEST(Measures, ANotchMakesOneConcaveEdge) {
  // A roof of two slopes, pressed in along its ridge.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0.5f, 0.3f}, {1, 0.5f, 0.3f}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(convexity(mesh).concave, 1u);
  mesh.positions[2].z = mesh.positions[3].z = -0.3f;
  EXPECT_EQ(convexity(mesh).convex, 1u);
  mesh.positions[2].z = mesh.positions[3].z = 0;
  EXPECT_EQ(convexity(mesh).flat, 1u);
}

}  // namespace
}  // namespace tafoni::mesh
