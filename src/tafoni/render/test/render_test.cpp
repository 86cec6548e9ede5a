#include "tafoni/render/render.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/math/whole.h"
#include "tafoni/render/test/shapes.h"

namespace tafoni::render {
namespace {

using testing::HasSubstr;

constexpr std::array<std::uint8_t, 4> grey{90, 90, 90, 255}, red{160, 20, 20, 255};

double brightness(const std::array<std::uint8_t, 4>& p) {
  return p[0] + p[1] + p[2];
}

/// Where a world position lies in the picture.
const std::array<std::uint8_t, 4>& pixel_at(const raster::Image& image, const Camera& camera, Vec3d world) {
  const Vec3d f = normalized(camera.target - camera.eye), r = normalized(cross(f, camera.up)),
              u = cross(r, f);
  const Vec3d d = world - camera.eye;
  const double tan_y = std::tan(camera.fov / 2), tan_x = tan_y * image.width() / image.height();
  const double x = dot(d, r) / (tan_x * dot(d, f)), y = dot(d, u) / (tan_y * dot(d, f));
  return image.at(floor_to((x + 1) / 2 * image.width()), floor_to((1 - y) / 2 * image.height()));
}

RenderSettings small() {
  RenderSettings settings;
  settings.width = 160;
  settings.height = 90;
  settings.haze = 0;
  return settings;
}

/// A floor with a slab that floats above its middle.
mesh::Mesh floor_and_slab() {
  mesh::Mesh mesh;
  mesh.origin = {700000, 5000000, 50};
  add_flat_box(mesh, {-50, -50, -5}, {50, 50, 0}, grey);
  add_flat_box(mesh, {-8, -8, 10}, {8, 8, 12}, grey);
  return mesh;
}

Camera above(const mesh::Mesh& mesh) {
  return {mesh.origin + Vec3d{0, -120, 60}, mesh.origin};
}

TEST(Render, ShadowLiesOppositeTheSun) {
  const mesh::Mesh mesh = floor_and_slab();
  RenderSettings settings = small();
  settings.sun_elevation = std::atan(0.5);
  const Scene scene(mesh);
  for (const double azimuth : {0.5 * M_PI, 1.5 * M_PI}) {
    settings.sun_azimuth = azimuth;
    const raster::Image image = scene.render(above(mesh), settings);
    // At this height the slab's middle casts its shadow 22 m away from the sun.
    const Vec3d shadow{-22 * std::sin(azimuth), 0, 0};
    const double dark = brightness(pixel_at(image, above(mesh), mesh.origin + shadow));
    const double lit = brightness(pixel_at(image, above(mesh), mesh.origin - shadow));
    EXPECT_LT(dark, 0.75 * lit);
    EXPECT_GT(dark, 0.1 * lit) << "the sky must light the shadow";
  }
}

TEST(Render, CreviceIsDarkerThanOpenGround) {
  mesh::Mesh mesh;
  add_flat_box(mesh, {-50, -50, -5}, {50, 50, 0}, grey);
  add_flat_box(mesh, {-30, 2, 0}, {0, 20, 30}, grey);
  add_flat_box(mesh, {-30, -20, 0}, {0, -2, 30}, grey);
  const Camera camera{{60, 0, 90}, {0, 0, 0}};
  RenderSettings settings = small();
  settings.sun_elevation = -0.3;  // only sky
  const raster::Image image = Scene(mesh).render(camera, settings);
  EXPECT_LT(brightness(pixel_at(image, camera, {-12, 0, 0})),
            0.7 * brightness(pixel_at(image, camera, {30, 0, 0})));
}

TEST(Render, SameBytesAtAnyThreadCount) {
  mesh::Mesh mesh = terrain(80, 2);
  RenderSettings settings = small();
  settings.sea_level = mesh.origin.z + 1;
  raster::Image first;
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    const raster::Image image = render(mesh, {}, settings);
    if (threads == 1)
      first = image;
    else
      EXPECT_EQ(image.values(), first.values()) << threads << " threads";
  }
  set_thread_count(0);
}

TEST(Render, FewSamplesLookLikeMany) {
  const mesh::Mesh mesh = floor_and_slab();
  RenderSettings settings = small();
  const Scene scene(mesh);
  settings.samples = 8;
  const raster::Image few = scene.render(above(mesh), settings);
  settings.samples = 256;
  const raster::Image many = scene.render(above(mesh), settings);
  double squares = 0;
  for (std::size_t i = 0; i < few.size(); ++i)
    squares += std::pow(brightness(few.values()[i]) - brightness(many.values()[i]), 2) / 9;
  // In 8-bit steps of a channel.
  EXPECT_LT(std::sqrt(squares / double(few.size())), 5.0);
}

TEST(Render, WaterTintsButShowsWhatStandsInIt) {
  mesh::Mesh mesh;
  add_flat_box(mesh, {-50, -50, -30}, {50, 50, -20}, grey);
  add_flat_box(mesh, {-10, -10, -20}, {10, 10, -1}, red);
  const Camera camera{{0, -100, 100}, {0, 0, 0}};
  RenderSettings settings = small();
  const Scene scene(mesh);
  const auto dry = pixel_at(scene.render(camera, settings), camera, {0, 0, -1});
  const auto dry_floor = pixel_at(scene.render(camera, settings), camera, {-30, 0, -20});
  settings.sea_level = 0;
  const raster::Image image = scene.render(camera, settings);
  const auto shallow = pixel_at(image, camera, {0, 0, -1});
  const auto deep = pixel_at(image, camera, {-30, 0, -20});
  EXPECT_GT(dry[0], dry[2] + 30);
  EXPECT_GT(shallow[0], shallow[2] + 10) << "red under a metre of water must stay red";
  EXPECT_GT(deep[2], deep[0] + 20) << "deep water is blue";
  EXPECT_NEAR(dry_floor[0], dry_floor[2], 40);
}

TEST(Render, NormalsThatPointIntoTheRockLeaveNoBlackHoles) {
  mesh::Mesh mesh;
  add_flat_box(mesh, {-2, -3, 0}, {30, 3, 6}, grey, true);
  const Camera camera{{0, 0, 2.5}, {10, 0, 2.5}, {0, 0, 1}, 1.0};
  RenderSettings settings = small();
  settings.inside = true;
  const raster::Image sound = Scene(mesh).render(camera, settings);
  for (std::size_t i = 0; i < mesh.normals.size(); i += 3) mesh.normals[i] = -mesh.normals[i];
  const raster::Image crooked = Scene(mesh).render(camera, settings);
  for (std::size_t i = 0; i < sound.size(); ++i)
    ASSERT_GT(brightness(crooked.values()[i]), 0.25 * brightness(sound.values()[i])) << i;
}

TEST(Render, ABlockThrowsAShadowOnTheFloorItStandsOn) {
  mesh::Mesh mesh;
  add_flat_box(mesh, {-10, -10, 0}, {10, 10, 10}, grey);
  const Camera camera{{0, -60, 50}, {0, 0, 0}};
  RenderSettings settings = small();
  settings.sun_azimuth = 1.5 * M_PI;
  const raster::Image image = Scene(mesh).render(camera, settings);
  const double dark = brightness(pixel_at(image, camera, {13, 0, 0.0}));
  const double lit = brightness(pixel_at(image, camera, {-13, 0, 0.0}));
  EXPECT_LT(dark, 0.9 * lit);
}

TEST(Render, LampFallsOffWithDistanceAndLeavesNoWallBlack) {
  mesh::Mesh mesh;
  add_flat_box(mesh, {-2, -3, 0}, {60, 3, 6}, grey, true);
  const Camera camera{{0, 0, 2.5}, {10, 0, 2.5}, {0, 0, 1}, 1.0};
  RenderSettings settings = small();
  settings.inside = true;
  const raster::Image image = Scene(mesh).render(camera, settings);
  const double near = brightness(pixel_at(image, camera, {10, 0, 0.01}));
  const double middle = brightness(pixel_at(image, camera, {25, 0, 0.01}));
  const double far = brightness(pixel_at(image, camera, {45, 0, 0.01}));
  EXPECT_GT(near, middle);
  EXPECT_GT(middle, far);
  EXPECT_GT(far, 20);
  EXPECT_LT(near, 740);
}

TEST(Render, OwnNormalsAndColoursWhenTheMeshHasNone) {
  mesh::Mesh mesh = terrain(60, 2);
  const raster::Image image = render(mesh, {}, small());
  int greenish = 0, sky = 0;
  for (const auto& p : image.values()) {
    greenish += p[1] > p[2] + 15 ? 1 : 0;
    sky += p[2] >= p[0] ? 1 : 0;
  }
  EXPECT_GT(greenish, 1000);
  EXPECT_GT(sky, 500);
}

/// Standard deviation of the brightness of bare ground, triangles of 100 m, from `height` metres above.
double grain(double height) {
  mesh::Mesh mesh;
  add_flat_box(mesh, {-50, -50, -5}, {50, 50, 0}, grey);
  const raster::Image image = render(mesh, Camera{{3, -height, height}, {3, 0, 0}}, small());
  double sum = 0, squares = 0;
  for (const auto& p : image.values()) sum += brightness(p), squares += brightness(p) * brightness(p);
  const auto n = static_cast<double>(image.values().size());
  return std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)));
}

TEST(Render, WallsHaveGrainHoweverNearTheyAre) {
  for (const double height : {8.0, 1.0, 0.2}) EXPECT_GT(grain(height), 3) << height;
}

TEST(Render, RefusesCamerasAndSizesThatMakeNoPicture) {
  const mesh::Mesh mesh = terrain(10, 1);
  const Scene scene(mesh);
  const Camera camera = scene.frame(small());
  RenderSettings settings = small();
  settings.width = 0;
  EXPECT_THAT(error_of([&] { scene.render(camera, settings); }), HasSubstr("A picture of 0 x"));
  settings = small();
  settings.samples = 0;
  EXPECT_THAT(error_of([&] { scene.render(camera, settings); }),
              HasSubstr("0 samples a pixel cannot be drawn"));
  Camera blind = camera;
  blind.target = blind.eye;
  EXPECT_THAT(error_of([&] { scene.render(blind, small()); }), HasSubstr("eye and target must differ"));
  blind = camera;
  blind.fov = 4;
  EXPECT_THAT(error_of([&] { scene.render(blind, small()); }), HasSubstr("the angle of view be 0.06 to 177"));
  Camera down = camera;
  down.target = down.eye - Vec3d{0, 0, 5};
  EXPECT_NO_THROW(scene.render(down, small()));
}

TEST(Render, RefusesWhatLiesBeyondAllPlaces) {
  const mesh::Mesh sound = terrain(10, 1);
  const auto with = [&](auto&& change) {
    mesh::Mesh mesh = sound;
    change(mesh);
    return error_of([&] { const Scene scene(mesh); });
  };
  // Little beyond the limit, so that nothing is harmed where it should fail.
  EXPECT_THAT(with([](mesh::Mesh& m) { m.positions[7].y = -1.1e9f; }),
              HasSubstr("a vertex of the mesh lies 1.1e+09 m from its origin"));
  EXPECT_THAT(with([](mesh::Mesh& m) { m.positions[7].x = std::nanf(""); }), HasSubstr("is not finite"));
  EXPECT_THAT(with([](mesh::Mesh& m) { m.triangles[3][1] = 1u << 30; }),
              HasSubstr("a triangle names vertex 1073741824 of"));
  EXPECT_THAT(with([](mesh::Mesh& m) { m.normals.resize(3); }), HasSubstr("normals or colours for 3"));
  EXPECT_EQ(with([](mesh::Mesh& m) { m.positions[7].y = -0.9e9f; }), "");

  const Scene scene(sound);
  const Camera camera = scene.frame(small());
  for (const double far : {1.1e11, 1e300, std::numeric_limits<double>::infinity(), std::nan("")}) {
    Camera off = camera;
    off.eye.x = far;
    EXPECT_THAT(error_of([&] { scene.render(off, small()); }), HasSubstr("The camera's eye is"));
    EXPECT_THAT(error_of([&] { (void)scene.frame_inside(small(), off.eye); }), HasSubstr("eye is"));
    off = camera;
    off.target.z = -far;
    EXPECT_THAT(error_of([&] { scene.render(off, small()); }), HasSubstr("The camera's target is"));
    RenderSettings settings = small();
    settings.sun_azimuth = far;
    EXPECT_THAT(error_of([&] { scene.render(camera, settings); }),
                HasSubstr("cannot be drawn with a setting"));
    settings = small();
    settings.azimuth = far;
    EXPECT_THAT(error_of([&] { (void)scene.frame(settings); }), HasSubstr("cannot be drawn with a setting"));
  }
}

TEST(Render, CanBeCancelled) {
  struct Stopping : Progress {
    void on_advance(std::uint64_t done) override {
      if (done > 3) cancel();
    }
  } progress;
  const mesh::Mesh mesh = terrain(10, 1);
  EXPECT_EQ(error_of([&] { render(mesh, {}, small(), progress); }), "cancelled");
}

}  // namespace
}  // namespace tafoni::render
