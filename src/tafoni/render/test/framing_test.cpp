#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/math/draw.h"
#include "tafoni/render/render.h"
#include "tafoni/render/test/shapes.h"

namespace tafoni::render {
namespace {

using testing::HasSubstr;

constexpr double pi = std::numbers::pi;

struct Extent {
  double x = 0, y = 0;  ///< greatest distance from the middle, 1 at the picture's edge
  bool behind = false;
};

Extent project(const mesh::Mesh& mesh, const Camera& camera, const RenderSettings& settings) {
  const Vec3d f = normalized(camera.target - camera.eye), r = normalized(cross(f, camera.up)),
              u = cross(r, f);
  const double tan_y = std::tan(camera.fov / 2), tan_x = tan_y * settings.width / settings.height;
  Extent extent;
  for (const Vec3f p : mesh.positions) {
    const Vec3d d = to_double(p) + mesh.origin - camera.eye;
    extent.behind |= dot(d, f) <= 0;
    extent.x = std::max(extent.x, std::abs(dot(d, r)) / (tan_x * dot(d, f)));
    extent.y = std::max(extent.y, std::abs(dot(d, u)) / (tan_y * dot(d, f)));
  }
  return extent;
}

TEST(Frame, HoldsTheWholeMeshAndFillsThePicture) {
  Random random(4);
  for (int round = 0; round < 30; ++round) {
    mesh::Mesh mesh = terrain(24, random.uniform(0, 2 * pi));
    const Vec3f stretch{draw_float(random, 0.2, 20), draw_float(random, 0.2, 20),
                        draw_float(random, 0.1, 20)};
    for (Vec3f& p : mesh.positions) p = {p.x * stretch.x, p.y * stretch.y, p.z * stretch.z};
    RenderSettings settings;
    settings.width = 200 + draw_index(random, 1800);
    settings.height = 200 + draw_index(random, 1800);
    if (round % 2) settings.elevation = random.uniform(-0.5, 1.4);
    const Extent extent = project(mesh, Scene(mesh).frame(settings), settings);
    EXPECT_FALSE(extent.behind);
    EXPECT_LE(std::max(extent.x, extent.y), 1.0);
    EXPECT_GE(std::max(extent.x, extent.y), 0.95) << "the mesh could be nearer";
  }
}

TEST(Frame, PutsTheMeshInTheMiddle) {
  const mesh::Mesh mesh = terrain(40, 2);
  for (const int height : {200, 500, 1500}) {
    RenderSettings settings;
    settings.height = height;
    const Camera camera = Scene(mesh).frame(settings);
    const Vec3d f = normalized(camera.target - camera.eye), r = normalized(cross(f, camera.up)),
                u = cross(r, f);
    double left = 1e9, right = -1e9, low = 1e9, high = -1e9;
    for (const Vec3f p : mesh.positions) {
      const Vec3d d = to_double(p) + mesh.origin - camera.eye;
      left = std::min(left, dot(d, r) / dot(d, f));
      right = std::max(right, dot(d, r) / dot(d, f));
      low = std::min(low, dot(d, u) / dot(d, f));
      high = std::max(high, dot(d, u) / dot(d, f));
    }
    EXPECT_NEAR(-left, right, 0.02 * right);
    EXPECT_NEAR(-low, high, 0.02 * high);
  }
}

TEST(Frame, LooksAtTheCliff) {
  for (const double azimuth : {0.3, 1.9, 3.3, 5.0}) {
    const mesh::Mesh mesh = terrain(60, azimuth);
    const Camera camera = Scene(mesh).frame({});
    const Vec3d to_eye = normalized(camera.eye - camera.target);
    const double facing = to_eye.x * std::sin(azimuth) + to_eye.y * std::cos(azimuth);
    EXPECT_GT(facing, 0.4) << azimuth;
  }
}

TEST(Frame, KeepsTheGivenDirection) {
  const mesh::Mesh mesh = terrain(20, 1);
  RenderSettings settings;
  settings.azimuth = 2.0;
  settings.elevation = 0.3;
  const Camera camera = Scene(mesh).frame(settings);
  const Vec3d f = normalized(camera.target - camera.eye);
  EXPECT_NEAR(std::atan2(f.x, f.y), 2.0, 1e-9);
  EXPECT_NEAR(std::asin(-f.z), 0.3, 1e-9);
}

/// A block with a corridor in it, 40 m long, that opens to the east.
mesh::Mesh block_with_corridor() {
  mesh::Mesh mesh;
  mesh.origin = {1000, 2000, 300};
  add_flat_box(mesh, {-50, -50, -20}, {50, 50, 30}, {80, 80, 80, 255});
  add_flat_box(mesh, {-20, -3, 0}, {30, 3, 6}, {80, 80, 80, 255}, true);
  return mesh;
}

TEST(FrameInside, FindsTheCaveAndLooksAlongIt) {
  const mesh::Mesh mesh = block_with_corridor();
  const Camera camera = Scene(mesh).frame_inside({});
  const Vec3d eye = camera.eye - mesh.origin, f = normalized(camera.target - camera.eye);
  EXPECT_TRUE((Box3d{{-20, -3, 0}, {30, 3, 6}}).contains(eye)) << eye.x << ' ' << eye.y << ' ' << eye.z;
  EXPECT_GT(std::abs(f.x), 0.9);
}

TEST(FrameInside, KeepsTheGivenEyeAndRefusesOpenGround) {
  const mesh::Mesh mesh = block_with_corridor();
  const Vec3d eye{985, 2001, 303};
  EXPECT_NEAR(length(Scene(mesh).frame_inside({}, eye).eye - eye), 0, 1e-3);
  EXPECT_THAT(error_of([&] { Scene(terrain(30, 1)).frame_inside({}); }),
              HasSubstr("there is no inside to look at"));
}

TEST(Frame, WhatLiesBelowTheSeaNeedsNoRoom) {
  mesh::Mesh mesh;
  add_box(mesh, {-10, -10, 1}, {10, 10, 20});
  RenderSettings settings;
  settings.sea_level = 0;
  settings.azimuth = 1;
  settings.elevation = 0.4;
  const Camera island = Scene(mesh).frame(settings);
  add_box(mesh, {-300, -300, -40}, {300, 300, -30});
  const Camera with_floor = Scene(mesh).frame(settings);
  EXPECT_NEAR(length(island.eye - with_floor.eye), 0, 1e-6);
  settings.sea_level = {};
  EXPECT_GT(length(Scene(mesh).frame(settings).eye), 3 * length(island.eye));
}

TEST(Frame, RefusesAnEmptyMesh) {
  EXPECT_THAT(error_of([&] { Scene(mesh::Mesh{}); }), HasSubstr("has no triangles"));
}

}  // namespace
}  // namespace tafoni::render
