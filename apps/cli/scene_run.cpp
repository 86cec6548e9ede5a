// From a document to its outputs: all of them are checked first, then the scene is built, meshed or sampled,
// and written.
#include "scene_run.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tafoni/core/atomic_file.h"
#include "tafoni/io/format.h"
#include "tafoni/io/image_file.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/mesh/texture.h"
#include "tafoni/scene/products/facts.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/scene/products/report.h"
#include "tafoni/scene/products/volume_scene.h"

namespace tafoni::cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// What -o asks for, by what it is.
struct Files {
  std::vector<std::string> meshes, volumes;

  explicit Files(const OutputOptions& outputs) {
    for (const std::string& file : outputs.files) {
      const auto& format = io::format_of(file, {io::Ability::write_mesh, io::Ability::write_volume});
      (format.write_mesh ? meshes : volumes).push_back(file);
    }
  }
};

void check_outputs(const scene::Document& document, const std::string& scene_file,
                   const OutputOptions& outputs) {
  if (!outputs.builds() && outputs.save_scene.empty() && !outputs.dry_run)
    fail(ErrorKind::usage, "nothing to write: give -o FILE, --preview PNG, --report JSON or --dry-run");
  const Files files(outputs);
  if (files.volumes.empty() && (outputs.band || outputs.half || !outputs.values.empty()))
    fail(ErrorKind::usage, "--band, --half and --values are for volumes; give -o FILE.tvol or FILE.vdb");
  if (outputs.texture && std::none_of(files.meshes.begin(), files.meshes.end(), [](const std::string& file) {
        return io::format_of(file, {io::Ability::write_mesh}).texture;
      }))
    fail(ErrorKind::usage,
         "--texture is for meshes that hold texture coordinates; give -o FILE.glb or FILE.obj");
  if (!outputs.preview.empty()) io::format_of(outputs.preview, io::Ability::write_image);
  const bool tiled = outputs.tiles.value_or(1) > 1;
  if (tiled && !files.volumes.empty())
    fail(ErrorKind::usage, "{}: a volume is written as a whole; leave out --tiles", files.volumes.front());
  if (tiled && !outputs.preview.empty())
    fail(ErrorKind::usage, "--preview needs the whole mesh at once; leave out --tiles, or use tafoni render");

  std::vector<fs::path> inputs = inputs_of(document);
  if (!outputs.save_scene.empty()) {
    if (!is_scene_file(outputs.save_scene))
      fail(ErrorKind::usage, "{}: a scene file must end in .toml", outputs.save_scene);
    check_output(outputs.save_scene, inputs);
  }
  if (!scene_file.empty()) inputs.push_back(scene_file);
  std::vector<std::string> seen = {outputs.save_scene};
  std::vector<std::string> wanted = outputs.files;
  wanted.insert(wanted.end(), {outputs.preview, outputs.report});
  for (const std::string& path : wanted) {
    if (path.empty()) continue;
    if (std::find(seen.begin(), seen.end(), path) != seen.end())
      fail(ErrorKind::usage, "{}: is asked for twice; give each output a name of its own", path);
    check_output(path, inputs);
    seen.push_back(path);
  }
}

io::MeshMetadata metadata(const scene::BuiltScene& scene, const std::string& path) {
  io::MeshMetadata data;
  data.name = fs::path(path).stem().string();
  data.crs = scene.crs;
  data.generator["program"] = "tafoni " + std::string(scene::version());
  data.generator["seed"] = scene.document.scene.seed;
  data.generator["voxel"] = scene.voxel;
  return data;
}

/// Tiles in the making; they take their places together at the end.
class TileFolder {
 public:
  explicit TileFolder(const fs::path& target)
      : target_(target),
        folder_(target.parent_path() / fmt::format(".{}.{}", target.filename().string(), ::getpid())) {
    std::error_code code;
    if (!fs::create_directories(folder_, code))
      fail(ErrorKind::output, "{}: no folder can be made beside it; check permissions and space",
           target.string());
  }
  ~TileFolder() {
    std::error_code code;
    fs::remove_all(folder_, code);
  }
  TileFolder(const TileFolder&) = delete;
  TileFolder& operator=(const TileFolder&) = delete;

  fs::path next(surface::TileIndex index) {
    names_.push_back(
        fmt::format("{}_{}_{}{}", target_.stem().string(), index.x, index.y, target_.extension().string()));
    return folder_ / names_.back();
  }
  std::vector<fs::path> commit() {
    std::vector<fs::path> out;
    for (const std::string& name : names_) {
      out.push_back(target_.parent_path() / name);
      std::error_code code;
      fs::rename(folder_ / name, out.back(), code);
      if (code)
        fail(ErrorKind::output, "{}: cannot be put in place: {}", out.back().string(), code.message());
    }
    return out;
  }

 private:
  fs::path target_, folder_;
  std::vector<std::string> names_;
};

std::string file_line(const fs::path& path) {
  std::error_code code;
  const auto bytes = fs::file_size(path, code);
  return fmt::format("{}  {}\n", path.string(), code ? "" : as_bytes(bytes));
}

/// What a person wants to know of a scene.
std::string summary(const scene::BuiltScene& scene, const scene::Report& report) {
  std::string out;
  for (const scene::LayerResult& layer : scene.layers) {
    const std::string facts = scene::facts_text(layer.made.facts);
    out += fmt::format("layer {}: {} primitives{}{}\n", layer.name,
                       with_commas(scene::primitives_of(layer.made)), facts.empty() ? "" : ", ", facts);
  }
  if (!report.mesh()) return out;
  const scene::MeshCounts& mesh = *report.mesh();
  out += fmt::format("mesh: {} triangles, {} pieces, voxel {:.6g} m", with_commas(mesh.triangles),
                     with_commas(mesh.components), scene.voxel);
  if (mesh.metrics && mesh.metrics->closed) out += fmt::format(", closed, {:.6g} m3", mesh.metrics->volume);
  if (mesh.fragments_removed > 0)
    out += fmt::format(", {} floating pieces removed", with_commas(mesh.fragments_removed));
  return out + "\n";
}

double band_of(const OutputOptions& outputs, const scene::BuiltScene& scene) {
  return outputs.band.value_or(4 * scene.voxel);
}

/// Programs that read .vdb take what is in it for distances.
bool holds_distances(const std::string& file, const OutputOptions& outputs) {
  return outputs.values.empty() ? io::format_of(file, io::Ability::write_volume).about.name == "vdb"
                                : outputs.values == "distance";
}

void print_prediction(const scene::BuiltScene& scene, const OutputOptions& outputs, Console& console) {
  const scene::Prediction p = scene::predict(scene, console);
  const Files files(outputs);
  Vec3i n{0, 0, 0};
  std::uint64_t volume_bytes = 0;
  if (!files.volumes.empty()) {
    const bool distance = holds_distances(files.volumes.front(), outputs);
    const double band =
        distance ? scene::level_set_reach(scene, band_of(outputs, scene)) : band_of(outputs, scene);
    n = scene::volume_frame(scene, band, distance ? surface::Boundary::solid : scene.boundary(), console)
            .size;
    // Two triangles a cell of the surface; what is within the band of it is stored sample by sample.
    const double all = static_cast<double>(n.x) * n.y * n.z;
    const double near = band > 0 ? static_cast<double>(p.triangles) * band / scene.voxel : all;
    volume_bytes = static_cast<std::uint64_t>(std::min(near, all)) * (outputs.half ? 2 : 4);
  }
  if (console.json()) {
    Json json = {{"voxel_m", p.voxel},
                 {"triangles", p.triangles},
                 {"vertices", p.vertices},
                 {"memory_bytes", p.memory},
                 {"glb_bytes", p.file_bytes}};
    if (volume_bytes > 0) json["samples"] = {n.x, n.y, n.z}, json["volume_bytes"] = volume_bytes;
    console.result(json.dump(2) + "\n");
    return;
  }
  std::string out = fmt::format(
      "at a voxel of {:g} m, judged from one of {:g} m:\n"
      "triangles  about {}\nmemory     about {}\n",
      p.voxel, p.coarse_voxel, with_commas(p.triangles), as_bytes(p.memory));
  if (files.volumes.empty() || !files.meshes.empty())
    out += fmt::format("GLB file   about {}\n", as_bytes(p.file_bytes));
  if (volume_bytes > 0)
    out += fmt::format("volume     {} x {} x {} samples, about {} before it is packed\n", n.x, n.y, n.z,
                       as_bytes(volume_bytes));
  console.result(out);
}

scene::MeshResult write_tiles(const scene::BuiltScene& scene, const std::vector<std::string>& files,
                              const OutputOptions& outputs, std::vector<fs::path>& written,
                              Console& console) {
  std::deque<TileFolder> folders;
  for (const std::string& file : files) folders.emplace_back(file);
  scene::MeshResult result = scene::mesh_scene_tiles(
      scene, static_cast<int>(*outputs.tiles),
      [&](surface::TileIndex index, mesh::Mesh&& tile) {
        if (tile.triangles.empty()) return;
        if (outputs.texture) mesh::box_texture(tile, *outputs.texture);
        for (std::size_t i = 0; i < files.size(); ++i)
          io::write_mesh(folders[i].next(index), tile, metadata(scene, files[i]), console);
      },
      console);
  for (TileFolder& folder : folders)
    for (auto& path : folder.commit()) written.push_back(std::move(path));
  return result;
}

scene::MeshResult write_whole(const scene::BuiltScene& scene, const std::vector<std::string>& files,
                              const OutputOptions& outputs, std::vector<fs::path>& written,
                              Console& console) {
  scene::MeshResult result = scene::mesh_scene(scene, console);
  if (result.mesh.triangles.empty() && result.stats.fragments_removed > 0)
    fail(ErrorKind::input,
         "nothing is left: every piece of the scene is smaller than {:g} m3 and was removed; give a smaller "
         "scene.min_fragment",
         scene.document.scene.min_fragment);
  if (result.mesh.triangles.empty())
    fail(ErrorKind::input, "the scene has no surface; check the terrain's window, domain and voxel size");
  if (outputs.texture) mesh::box_texture(result.mesh, *outputs.texture);
  for (const std::string& file : files) {
    io::write_mesh(file, result.mesh, metadata(scene, file), console);
    written.emplace_back(file);
  }
  if (!outputs.preview.empty()) {
    render::RenderSettings settings;
    settings.sea_level = scene::sea_level(scene.document);
    const render::Scene picture(result.mesh, console);
    io::write_image(outputs.preview, picture.render(picture.frame(settings), settings, console));
    written.emplace_back(outputs.preview);
  }
  return result;
}

void write_volumes(const scene::BuiltScene& scene, const OutputOptions& outputs,
                   const std::vector<std::string>& files, std::vector<fs::path>& written, Console& console) {
  volume::SampleSettings settings;
  settings.band = band_of(outputs, scene);
  if (outputs.half) settings.precision = volume::Precision::half;
  for (const bool distance : {false, true}) {
    std::optional<io::Volume> volume;
    for (const std::string& file : files) {
      if (holds_distances(file, outputs) != distance) continue;
      if (!volume)
        volume = distance ? scene::level_set(scene, settings, console)
                          : scene::sample_scene(scene, settings, console);
      volume->metadata = metadata(scene, file);
      io::write_volume(file, *volume, console);
      written.emplace_back(file);
    }
    if (!volume || console.json()) continue;
    const Vec3i n = volume->grid.frame().size;
    console.print(fmt::format("volume: {} x {} x {} samples of {:g} m, {} in memory\n", n.x, n.y, n.z,
                              volume->grid.frame().spacing, as_bytes(volume->grid.bytes())));
  }
}

}  // namespace

void run_scene(const scene::Document& document, const std::string& scene_file, const OutputOptions& outputs,
               Console& console) {
  check_outputs(document, scene_file, outputs);
  std::vector<fs::path> written;
  if (outputs.builds() || outputs.dry_run) {
    const scene::BuiltScene scene = scene::build(document, console);
    if (outputs.dry_run) return print_prediction(scene, outputs, console);
    const Files files(outputs);
    const std::int64_t tiles = outputs.tiles.value_or(1);
    std::optional<scene::MeshResult> result;
    if (tiles > 1 && !files.meshes.empty())
      result = write_tiles(scene, files.meshes, outputs, written, console);
    else if (!files.meshes.empty() || !outputs.preview.empty() || !outputs.report.empty())
      result = write_whole(scene, files.meshes, outputs, written, console);
    const scene::Report report(scene, result ? &*result : nullptr);
    const std::string json = report.json(console.warnings());
    if (!outputs.report.empty()) {
      write_file(outputs.report, json);
      written.emplace_back(outputs.report);
    }
    if (console.json())
      console.result(json);
    else
      console.print(summary(scene, report));
    if (!files.volumes.empty()) write_volumes(scene, outputs, files.volumes, written, console);
  }
  if (!outputs.save_scene.empty()) {
    scene::save_scene(document, outputs.save_scene);
    written.emplace_back(outputs.save_scene);
  }
  if (!console.json())
    for (const fs::path& path : written) console.print(file_line(path));
}

}  // namespace tafoni::cli
