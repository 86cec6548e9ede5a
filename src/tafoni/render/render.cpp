// A picture from beginning to end: the camera becomes a view, the scene's light is chosen for what it
// sees, tiles are drawn on all threads, and the film is mended and developed.

#include "tafoni/render/render.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/mesh/inner/traceable.h"
#include "tafoni/render/impl/film.h"
#include "tafoni/render/impl/framing.h"
#include "tafoni/render/impl/integrator.h"
#include "tafoni/render/impl/world.h"

namespace tafoni::render {
namespace {

using impl::Film;
using impl::Light;
using impl::View;

constexpr int tile = 32;  // pixels a side of what a thread draws at a time

// The light, chosen by eye.
constexpr double sun_from_left =
    1.90;  // radians from the view to the sun: shadows fall towards us and across
constexpr float lamp_up = 0.10f,
                lamp_right = 0.12f;   // of its reach: off the eye, or nothing would show shadows
constexpr float lamp_radius = 0.02f;  // of its reach
constexpr float lamp_room = 1.2f;     // of the way to the lamp that must be free, or it stands in the wall
constexpr float clear_air =
    0.6f;  // of the typical distance is without haze, so that what is near keeps its colours
constexpr double haze_depth = 0.11;  // optical depth that the typical distance would have
constexpr int sky_directions = 256;  // stand for all of the sky

/// Rays begin where floats still can tell the mesh, however large that is; `what` is local.
void check_place(Vec3d what, const char* name) {
  for (const double d : {what.x, what.y, what.z})
    if (!(std::abs(d) <= 100 * mesh::inner::farthest_vertex))
      fail(
          ErrorKind::usage,
          "The camera's {} is {:g} m from the mesh's origin, where nothing can be drawn; give a place nearer "
          "to the mesh.",
          name, d);
}

void check_finite(const RenderSettings& s) {
  for (const double d : {s.sun_azimuth.value_or(0), s.sun_elevation, s.sun_radius, s.sea_level.value_or(0),
                         s.exposure, s.haze, s.azimuth.value_or(0), s.elevation.value_or(0)})
    if (!(std::abs(d) <= mesh::inner::farthest_vertex))
      fail(ErrorKind::usage, "A picture cannot be drawn with a setting of {:g}; give one in its range.", d);
}

/// `camera` is local here.
View view_of(const Camera& camera, const RenderSettings& settings) {
  if (settings.width < 1 || settings.height < 1 || settings.width > 16384 || settings.height > 16384)
    fail(ErrorKind::usage, "A picture of {} x {} pixels cannot be drawn; give 1 to 16384 a side.",
         settings.width, settings.height);
  if (settings.samples < 1 || settings.samples > 4096)
    fail(ErrorKind::usage, "{} samples a pixel cannot be drawn; give 1 to 4096.", settings.samples);
  check_finite(settings);
  check_place(camera.eye, "eye");
  check_place(camera.target, "target");
  const Vec3d forward = normalized(camera.target - camera.eye);
  Vec3d right = cross(forward, normalized(camera.up));
  // Straight up or down has no horizon to keep level; north is up in the picture then.
  if (length(right) < 1e-6) right = cross(forward, Vec3d{0, 1, 0});
  right = normalized(right);
  const bool sound = length(forward) > 0.5 && length(right) > 0.5 && camera.fov > 0.001 && camera.fov < 3.1;
  if (!sound)
    fail(ErrorKind::usage,
         "The camera makes no picture: eye and target must differ and the angle of view be 0.06 to 177 "
         "degrees.");
  const double half = std::tan(camera.fov / 2);
  View view;
  view.eye = to_float(camera.eye);
  view.forward = to_float(forward);
  view.right = to_float(right * (half * settings.width / settings.height));
  view.up = to_float(cross(right, forward) * half);
  view.width = settings.width;
  view.height = settings.height;
  return view;
}

/// The middle of the distances to what the camera sees; 0 when it sees nothing.
float typical_distance(const impl::World& world, const View& view) {
  std::vector<float> distances;
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 32; ++x) {
      const Vec3f d = view.direction((static_cast<float>(x) + 0.5f) * static_cast<float>(view.width) / 32,
                                     (static_cast<float>(y) + 0.5f) * static_cast<float>(view.height) / 18);
      if (const impl::Hit hit = world.tracer().closest(view.eye, d)) distances.push_back(hit.t);
    }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + distances.size() / 2;
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

Light light_of(const impl::World& world, const View& view, const RenderSettings& settings,
               std::optional<float> sea) {
  Light light;
  const double facing = std::atan2(view.forward.x, view.forward.y);
  const double azimuth = settings.sun_azimuth.value_or(facing - sun_from_left);
  light.to_sun =
      to_float({std::sin(azimuth) * std::cos(settings.sun_elevation),
                std::cos(azimuth) * std::cos(settings.sun_elevation), std::sin(settings.sun_elevation)});
  // A spiral of directions about the zenith stands for all of the sky.
  light.open_ground = Light::sun * std::max(0.0f, light.to_sun.z);
  for (int i = 0; i < sky_directions; ++i) {
    const impl::Point2 p{(static_cast<float>(i) + 0.5f) / sky_directions,
                         std::fmod(static_cast<float>(i) * 0.618034f, 1.0f)};
    light.open_ground += light.sky(impl::cosine_direction({0, 0, 1}, p)) * (1.0f / sky_directions);
  }
  light.sun_radius = static_cast<float>(settings.sun_radius);
  light.sea = sea;
  if (sea) light.sea_floor = world.floor_below(*sea);
  const float distance = typical_distance(world, view);
  if (settings.inside) {
    const float reach = std::max(distance, world.spacing());
    light.lamp = impl::Lamp{
        view.eye + normalized(view.up) * (lamp_up * reach) + normalized(view.right) * (lamp_right * reach),
        reach, lamp_radius * reach};
    // The lamp may not stand in the wall.
    if (world.tracer().blocked(view.eye, light.lamp->position - view.eye, lamp_room))
      light.lamp->position = view.eye;
  } else if (distance > 0) {
    light.haze_begin = clear_air * distance;
    light.haze_per_metre = static_cast<float>(haze_depth * settings.haze) / distance;
  }
  return light;
}

void draw_tile(const impl::Integrator& integrator, const View& view, std::uint32_t samples, int left, int top,
               Film& film) {
  const float footprint = 2 * length(view.up) / static_cast<float>(view.height);
  for (int y = top; y < std::min(top + tile, view.height); ++y)
    for (int x = left; x < std::min(left + tile, view.width); ++x) {
      impl::Pixel sum;
      int met = 0;
      for (std::uint32_t s = 0; s < samples; ++s) {
        const impl::Sampler sampler(x, y, s, samples);
        const impl::Point2 jitter = sampler.get(impl::Stream::pixel);
        const Vec3f d = view.through(x, y, jitter.u, jitter.v);
        const impl::Sample sample = integrator.eye_ray(view.eye, d, footprint, sampler);
        sum.color += sample.color;
        sum.light += sample.sky_light;
        sum.weight += sample.sky_weight;
        sum.normal += sample.normal;
        if (sample.t == impl::far_away) continue;
        sum.depth += sample.t;
        ++met;
      }
      const float share = 1.0f / static_cast<float>(samples);
      film.at(x, y) = {sum.color * share, sum.light * share, sum.weight * share, sum.normal * share,
                       met ? sum.depth / static_cast<float>(met) : 0.0f};
    }
}

}  // namespace

struct Scene::State {
  impl::World world;
  State(const mesh::Mesh& mesh, Progress& progress) : world(mesh, progress) {}

  std::optional<float> local_sea(const RenderSettings& settings) const {
    if (!settings.sea_level) return std::nullopt;
    return static_cast<float>(*settings.sea_level - world.mesh().origin.z);
  }
  Camera move(Camera camera, Vec3d by) const {
    camera.eye += by;
    camera.target += by;
    return camera;
  }
};

Scene::Scene(const mesh::Mesh& mesh, Progress& progress) : state_(std::make_unique<State>(mesh, progress)) {}
Scene::~Scene() = default;

Camera Scene::frame(const RenderSettings& settings) const {
  check_finite(settings);
  return state_->move(impl::best_outside(state_->world, settings, state_->local_sea(settings)),
                      state_->world.mesh().origin);
}

Camera Scene::frame_inside(const RenderSettings& settings, std::optional<Vec3d> eye) const {
  check_finite(settings);
  std::optional<Vec3f> local;
  if (eye) {
    check_place(*eye - state_->world.mesh().origin, "eye");
    local = to_float(*eye - state_->world.mesh().origin);
  }
  return state_->move(impl::best_inside(state_->world, local, state_->local_sea(settings)),
                      state_->world.mesh().origin);
}

raster::Image Scene::render(const Camera& camera, const RenderSettings& settings, Progress& progress) const {
  const impl::World& world = state_->world;
  const std::optional<float> sea = state_->local_sea(settings);
  const View view = view_of(state_->move(camera, -world.mesh().origin), settings);
  const Light light = light_of(world, view, settings, sea);
  const impl::Colors colors = world.colors(sea, progress);
  const impl::Integrator integrator(world, colors, light);
  // A power of two keeps every pixel's samples a whole net.
  const std::uint32_t samples = std::bit_ceil<std::uint32_t>(settings.samples);
  Film film(view.width, view.height);
  const int across = (view.width + tile - 1) / tile, down = (view.height + tile - 1) / tile;
  progress.begin("drawing the picture", std::int64_t{across} * down, "tiles");
  parallel_for(
      std::int64_t{across} * down,
      [&](int i) { draw_tile(integrator, view, samples, i % across * tile, i / across * tile, film); },
      progress);
  impl::denoise(film, view);
  progress.end();
  return impl::develop(film, settings.exposure);
}

raster::Image render(const mesh::Mesh& mesh, const std::optional<Camera>& camera,
                     const RenderSettings& settings, Progress& progress) {
  const Scene scene(mesh, progress);
  const Camera own = camera            ? *camera
                     : settings.inside ? scene.frame_inside(settings)
                                       : scene.frame(settings);
  return scene.render(own, settings, progress);
}

}  // namespace tafoni::render
