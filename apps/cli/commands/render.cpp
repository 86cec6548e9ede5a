// tafoni render: a picture of a scene or a mesh, from outside, from inside, or cut open to show its rock.
#include "tafoni/render/render.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <utility>

#include "command.h"
#include "cost.h"
#include "scene_run.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/clock.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/image_file.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/math/angle.h"
#include "tafoni/scene/products/cut.h"
#include "tafoni/scene/products/mesh_scene.h"

namespace tafoni::cli::command_render {
namespace {

struct Render {
  std::string input, output;
  SceneOptions scene;
  std::vector<double> camera, inside, size, cut;
  bool is_inside = false, geology = false, force = false;
  std::optional<double> fov, azimuth, elevation, sun_azimuth, sun_elevation, exposure, haze, sea_level;
  std::optional<std::int64_t> samples;
};

render::RenderSettings settings_of(const Render& r) {
  render::RenderSettings s;
  if (!r.size.empty()) {
    s.width = static_cast<int>(r.size[0]);
    s.height = static_cast<int>(r.size[1]);
    if (s.width < 1 || s.height < 1 || s.width > 16384 || s.height > 16384)
      fail(ErrorKind::usage, "--size {:g},{:g}: must be 1 to 16384 pixels each way", r.size[0], r.size[1]);
  }
  if (r.samples) s.samples = static_cast<int>(*r.samples);
  if (r.sun_azimuth) s.sun_azimuth = *r.sun_azimuth * degree;
  if (r.sun_elevation) s.sun_elevation = *r.sun_elevation * degree;
  if (r.azimuth) s.azimuth = *r.azimuth * degree;
  if (r.elevation) s.elevation = *r.elevation * degree;
  if (r.exposure) s.exposure = *r.exposure;
  if (r.haze) s.haze = *r.haze;
  s.sea_level = r.sea_level;
  s.inside = r.is_inside;
  return s;
}

render::Camera camera_of(const Render& r, const render::Scene& scene,
                         const render::RenderSettings& settings) {
  render::Camera camera;
  if (!r.camera.empty()) {
    camera.eye = {r.camera[0], r.camera[1], r.camera[2]};
    camera.target = {r.camera[3], r.camera[4], r.camera[5]};
  } else if (r.is_inside) {
    std::optional<Vec3d> eye;
    if (!r.inside.empty()) eye = Vec3d{r.inside[0], r.inside[1], r.inside[2]};
    camera = scene.frame_inside(settings, eye);
  } else {
    camera = scene.frame(settings);
  }
  if (r.fov) camera.fov = *r.fov * degree;
  return camera;
}

// How a scene that is cut open is shown, chosen by eye, in degrees. The camera stands on the side that was
// removed, turned a quarter of a right angle from square to the cut, so that the end wall shows as well, and
// looks down so little that the cut is hardly foreshortened. The sun lies along the cut and models its edges.
constexpr double cut_azimuth = -115, cut_elevation = 22, cut_sun_azimuth = 48;

/// Asks whether the picture of a scene fits.
void check_scene_cost(const Render& r, const scene::BuiltScene& scene, const render::RenderSettings& settings,
                      Console& console) {
  if (r.force) return;
  Work work;
  work.picture = true;
  work.pixels = 1.0 * settings.width * settings.height;
  check_cost(scene, work, console);
}

/// The scene cut open, looked at squarely enough that the cut shows undistorted.
mesh::Mesh geology_of(const Render& r, const scene::Document& document, render::RenderSettings& settings,
                      Console& console) {
  const scene::BuiltScene scene = scene::build(document, console);
  check_scene_cost(r, scene, settings, console);
  scene::Cut cut = scene::middle_cut(scene);
  if (!r.cut.empty()) cut = {{r.cut[0], r.cut[1]}, {r.cut[2], r.cut[3]}};
  const Vec2d along = cut.to - cut.from;
  if (!settings.azimuth) settings.azimuth = std::atan2(along.x, along.y) + cut_azimuth * degree;
  if (!settings.elevation) settings.elevation = cut_elevation * degree;
  if (!settings.sun_azimuth) settings.sun_azimuth = std::atan2(along.x, along.y) + cut_sun_azimuth * degree;
  if (!r.haze) settings.haze = 0;
  return scene::cut_mesh(scene, cut, console);
}

mesh::Mesh mesh_of(const Render& r, render::RenderSettings& settings, Console& console) {
  if (is_mesh_file(r.input)) {
    if (r.geology) fail(ErrorKind::usage, "--geology: a mesh has no geology; give a scene");
    r.scene.check_unused(r.input);
    check_output(r.output, {r.input});
    return io::read_mesh(r.input);
  }
  scene::Document document = open_document(r.input);
  r.scene.apply(document);
  std::vector<std::filesystem::path> inputs = inputs_of(document);
  inputs.emplace_back(r.input);
  check_output(r.output, inputs);
  if (r.geology) return geology_of(r, document, settings, console);
  if (!settings.sea_level) settings.sea_level = scene::sea_level(document);
  const scene::BuiltScene scene = scene::build(document, console);
  check_scene_cost(r, scene, settings, console);
  return scene::mesh_scene(scene, console).mesh;
}

int run(const Render& r, Console& console) {
  if (r.output.empty()) fail(ErrorKind::usage, "render needs -o PICTURE to write, a .png or .jpg");
  io::format_of(r.output, io::Ability::write_image);
  render::RenderSettings settings = settings_of(r);
  if (!r.cut.empty() && !r.geology) fail(ErrorKind::usage, "--cut: needs --geology");
  if (!r.camera.empty() && (r.azimuth || r.elevation))
    fail(ErrorKind::usage, "--camera says where to look from; leave out --azimuth and --elevation");
  if (r.geology && r.is_inside) fail(ErrorKind::usage, "--geology and --inside exclude each other");
  if (!r.force) check_picture(1.0 * settings.width * settings.height);
  double start = now();
  const auto lap = [&start] { return now() - std::exchange(start, now()); };
  const mesh::Mesh mesh = mesh_of(r, settings, console);
  const double mesh_seconds = lap();
  const auto scene = of_file(r.input, [&] { return std::make_unique<const render::Scene>(mesh, console); });
  const render::Camera camera = camera_of(r, *scene, settings);
  const raster::Image picture = scene->render(camera, settings, console);
  const double picture_seconds = lap();
  io::write_image(r.output, picture);
  if (console.json())
    console.result(
        json_text({{"file", r.output},
                   {"width", settings.width},
                   {"height", settings.height},
                   {"camera",
                    {{"eye", {camera.eye.x, camera.eye.y, camera.eye.z}},
                     {"target", {camera.target.x, camera.target.y, camera.target.z}},
                     {"fov_deg", camera.fov / degree}}},
                   {"triangles", mesh.triangles.size()},
                   {"seconds", {{"mesh", mesh_seconds}, {"picture", picture_seconds}, {"write", lap()}}},
                   {"warnings", console.warnings()}}));
  else
    console.print(fmt::format("{}  {} x {} pixels\ncamera {},{},{},{},{},{}\n", r.output, settings.width,
                              settings.height, camera.eye.x, camera.eye.y, camera.eye.z, camera.target.x,
                              camera.target.y, camera.target.z));
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  auto r = std::make_shared<Render>();
  args.positional("SCENE|MESH", r->input,
                  "Path of a scene file (.toml), an elevation model, a volume or a mesh");
  args.text("-o,--output", "PICTURE", r->output, "Picture to write, PNG or JPG");
  args.group("View");
  args.numbers("--camera", "EX,EY,EZ,TX,TY,TZ", r->camera, 6,
               "Places of the eye and of what it looks at, in the scene's CRS; default: outside, where all "
               "of the terrain is in view");
  args.optional_numbers("--inside", "X,Y,Z", r->is_inside, r->inside, 3,
                        "Looks from within a cave, by a lamp at the eye: at X,Y,Z, written --inside=X,Y,Z, "
                        "or else in the roomiest cave");
  args.number(
      "--fov", "DEG", r->fov, 1, 170, "degrees",
      "Vertical angle of view: more shows more, and all of it smaller; default: 35, with --inside 69");
  args.number(
      "--azimuth", "DEG", r->azimuth, -360, 360, "degrees",
      "Direction of view, clockwise from north; default: the one that shows most of cliffs and undercuts");
  args.number(
      "--elevation", "DEG", r->elevation, -90, 90, "degrees",
      "How far the camera looks down, below 0 up; default: the one that shows most of cliffs and undercuts");
  args.numbers("--size", "W,H", r->size, 2, "Width and height of the picture in pixels; default: 1280,720");
  args.integer("--samples", "N", r->samples, 1, 4096,
               "Rays a pixel: more leaves less grain and takes longer; default: 8");
  args.flag("--geology", r->geology,
            "Cuts the terrain open and colours it by the rock's resistance: the paler, the more resistant");
  args.numbers("--cut", "X0,Y0,X1,Y1", r->cut, 4,
               "Ends of the line of the cut in the scene's CRS; what lies right of it is removed; default: "
               "from west to east through the middle");
  args.group("Light");
  args.number("--sun-azimuth", "DEG", r->sun_azimuth, -360, 360, "degrees",
              "Where the sun stands, clockwise from north; default: to the left of the camera");
  args.number("--sun-elevation", "DEG", r->sun_elevation, 0, 90, "degrees",
              "Height of the sun above the horizon: less makes longer shadows; default: 34");
  args.number("--exposure", "F", r->exposure, 0.01, 100, "",
              "Factor on the light: more makes the picture brighter; default: 1");
  args.number(
      "--haze", "F", r->haze, 0, 10, "",
      "Strength of the haze: more fades what is far away, 0 switches it off; default: 1, with --geology 0");
  args.number("--sea-level", "M", r->sea_level, -2e4, 2e4, "m",
              "Elevation of a water surface to draw; default: the scene's own, if it has one");
  r->scene.declare(args);
  args.flag("--force", r->force, "Makes also what seems to take more memory than there is");
  return [r](Console& console) { return run(*r, console); };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "render", .doc = "Make a picture of a scene or a mesh"},
      .examples =
          "  tafoni render terrain.glb -o terrain.png\n"
          "  tafoni render terrain.glb --inside -o cave.png\n"
          "  tafoni render scene.toml --geology -o rock.png\n"
          "  tafoni render scene.toml --camera 100,-200,80,300,300,10 -o view.png",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_render
