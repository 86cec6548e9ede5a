// From a document to its outputs: all of them are checked first, then the scene is built, meshed or sampled,
// and written.
#include "scene_run.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "cost.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/clock.h"
#include "tafoni/core/error.h"
#include "tafoni/core/files.h"
#include "tafoni/field/chunks.h"
#include "tafoni/io/format.h"
#include "tafoni/io/image_file.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/mesh/texture.h"
#include "tafoni/scene/products/facts.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/scene/products/report.h"
#include "tafoni/scene/products/volume_scene.h"
#include "tafoni/scene/sculpt/copy.h"

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

io::MeshMetadata metadata(const scene::BuiltScene& scene, const std::string& path) {
  io::MeshMetadata data;
  data.name = fs::path(path).stem().string();
  data.crs = scene.crs;
  data.generator["program"] = "tafoni " + std::string(scene::version());
  data.generator["seed"] = scene.document.scene.seed;
  data.generator["voxel"] = scene.voxel;
  return data;
}

/// The form that is asked for, as far as the file's format can have it.
io::MeshForm form_of(const OutputOptions& outputs, const std::string& file) {
  const io::FormatType& format = io::format_of(file, io::Ability::write_mesh);
  io::MeshForm form;
  if (!outputs.up.empty() && format.ups.find(outputs.up) != std::string::npos) form.up = outputs.up[0];
  form.world = outputs.world_coordinates && format.world;
  form.float_colors = outputs.float_colors && format.float_colors;
  return form;
}

/// Tiles in the making; they take their places together at the end.
class TileFolder {
 public:
  explicit TileFolder(const fs::path& target) : target_(target), folder_(target.parent_path()) {}

  fs::path next(surface::TileIndex index) {
    places_.push_back(tile_name(target_, index.x, index.y));
    return folder_.path() / places_.back().filename();
  }
  const std::vector<fs::path>& commit() {
    for (const fs::path& place : places_) {
      std::error_code code;
      fs::rename(folder_.path() / place.filename(), place, code);
      if (code) fail(ErrorKind::output, "{}: cannot be put in place: {}", place.string(), code.message());
    }
    return places_;
  }

 private:
  fs::path target_;
  TemporaryFolder folder_;
  std::vector<fs::path> places_;
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

Work work_of(const scene::BuiltScene& scene, const OutputOptions& outputs) {
  const Files files(outputs);
  Work work;
  work.meshes = files.meshes;
  work.volumes = files.volumes;
  work.tiles = files.meshes.empty() ? 1 : static_cast<int>(outputs.tiles.value_or(1));
  work.picture = !outputs.preview.empty();
  work.meshed = !files.meshes.empty() || work.picture || !outputs.report.empty() || files.volumes.empty();
  work.distance = !files.volumes.empty() && holds_distances(files.volumes.front(), outputs);
  work.band =
      work.distance ? scene::level_set_reach(scene, band_of(outputs, scene)) : band_of(outputs, scene);
  work.half = outputs.half;
  return work;
}

/// Seconds of what was made of a mesh, by what that is.
struct Times {
  double picture = 0, write = 0;
};

template <class F>
void timed(double& seconds, const F& work) {
  const double start = now();
  work();
  seconds += now() - start;
}

[[noreturn]] void fail_without_surface(const scene::BuiltScene& scene, const scene::MeshResult& result) {
  if (result.stats.fragments_removed > 0)
    fail(ErrorKind::input,
         "nothing is left: every piece of the scene is smaller than {:g} m3 and was removed; give a smaller "
         "scene.min_fragment",
         scene.document.scene.min_fragment);
  fail(ErrorKind::input, "the scene has no surface; check the terrain's window, domain and voxel size");
}

/// Which tiles of all are no files, a few of them by name.
void tell_missing(int tiles, const std::vector<surface::TileIndex>& written, Console& console) {
  constexpr std::size_t named = 8;
  std::vector<bool> there(static_cast<std::size_t>(tiles) * tiles, false);
  for (const surface::TileIndex t : written) there[static_cast<std::size_t>(t.y) * tiles + t.x] = true;
  std::string names;
  std::size_t missing = 0;
  for (std::size_t at = 0; at < there.size(); ++at)
    if (!there[at] && missing++ < named)
      names += fmt::format("{}{}_{}", names.empty() ? "" : ", ", at % tiles, at / tiles);
  if (missing == 0) return;
  console.warn(
      fmt::format("{} of {} x {} tiles hold no surface and are not written: {}{}; a tile is made of whole "
                  "blocks of {} cells each way",
                  missing, tiles, tiles, names, missing > named ? ", …" : "", field::chunk_cells));
}

scene::MeshResult write_tiles(const scene::BuiltScene& scene, const std::vector<std::string>& files,
                              const OutputOptions& outputs, std::vector<fs::path>& written, Times& times,
                              Console& console) {
  std::deque<TileFolder> folders;
  for (const std::string& file : files) folders.emplace_back(file);
  const int tiles = static_cast<int>(*outputs.tiles);
  std::vector<surface::TileIndex> written_tiles;
  scene::MeshResult result = scene::mesh_scene_tiles(
      scene, tiles,
      [&](surface::TileIndex index, mesh::Mesh&& tile) {
        if (tile.triangles.empty()) return;
        if (outputs.texture) mesh::box_texture(tile, *outputs.texture);
        timed(times.write, [&] {
          for (std::size_t i = 0; i < files.size(); ++i)
            io::write_mesh(folders[i].next(index), tile, metadata(scene, files[i]), console,
                           form_of(outputs, files[i]));
        });
        written_tiles.push_back(index);
      },
      console);
  if (written_tiles.empty()) fail_without_surface(scene, result);
  tell_missing(tiles, written_tiles, console);
  for (TileFolder& folder : folders)
    for (const fs::path& path : folder.commit()) written.push_back(path);
  return result;
}

scene::MeshResult write_whole(const scene::BuiltScene& scene, const std::vector<std::string>& files,
                              const OutputOptions& outputs, std::vector<fs::path>& written, Times& times,
                              Console& console) {
  scene::MeshResult result = scene::mesh_scene(scene, console);
  if (result.mesh.triangles.empty()) fail_without_surface(scene, result);
  if (outputs.texture) mesh::box_texture(result.mesh, *outputs.texture);
  for (const std::string& file : files) {
    timed(times.write,
          [&] { io::write_mesh(file, result.mesh, metadata(scene, file), console, form_of(outputs, file)); });
    written.emplace_back(file);
  }
  if (!outputs.preview.empty()) {
    raster::Image picture;
    timed(times.picture, [&] {
      render::RenderSettings settings;
      settings.sea_level = scene::sea_level(scene.document);
      const render::Scene view(result.mesh, console);
      picture = view.render(view.frame(settings), settings, console);
    });
    timed(times.write, [&] { io::write_image(outputs.preview, picture); });
    written.emplace_back(outputs.preview);
  }
  return result;
}

std::string write_volumes(const scene::BuiltScene& scene, const OutputOptions& outputs,
                          const std::vector<std::string>& files, std::vector<fs::path>& written,
                          scene::Seconds& seconds, Console& console) {
  volume::SampleSettings settings;
  settings.band = band_of(outputs, scene);
  if (outputs.half) settings.precision = volume::Precision::half;
  std::string told;
  double sampled = 0, wrote = 0;
  for (const bool distance : {false, true}) {
    std::optional<io::Volume> volume;
    for (const std::string& file : files) {
      if (holds_distances(file, outputs) != distance) continue;
      if (!volume)
        timed(sampled, [&] {
          volume = distance ? scene::level_set(scene, settings, console)
                            : scene::sample_scene(scene, settings, console);
        });
      volume->metadata = metadata(scene, file);
      timed(wrote, [&] { io::write_volume(file, *volume, console); });
      written.emplace_back(file);
    }
    if (!volume) continue;
    const Vec3i n = volume->grid.frame().size;
    told += fmt::format("volume: {} x {} x {} samples of {:g} m, {} in memory\n", n.x, n.y, n.z,
                        volume->grid.frame().spacing, as_bytes(volume->grid.bytes()));
  }
  seconds.emplace_back("sample volume", sampled);
  seconds.emplace_back("write volume", wrote);
  return told;
}

/// Makes everything that is asked for, the report last, which tells of the rest.
void make_outputs(const scene::BuiltScene& scene, const OutputOptions& outputs,
                  std::vector<fs::path>& written, Console& console) {
  const Files files(outputs);
  const Work work = work_of(scene, outputs);
  if (!outputs.force) check_cost(scene, work, console);
  std::optional<scene::MeshResult> result;
  Times times;
  if (work.tiles > 1)
    result = write_tiles(scene, files.meshes, outputs, written, times, console);
  else if (work.meshed)
    result = write_whole(scene, files.meshes, outputs, written, times, console);
  scene::Seconds seconds;
  if (work.picture) seconds.emplace_back("picture", times.picture);
  if (times.write > 0) seconds.emplace_back("write", times.write);
  std::string volume;
  if (!files.volumes.empty())
    volume = write_volumes(scene, outputs, files.volumes, written, seconds, console);
  const scene::Report report(scene, result ? &*result : nullptr, seconds);
  const std::string json = report.json(console.warnings());
  if (!outputs.report.empty()) {
    write_file(outputs.report, json);
    written.emplace_back(outputs.report);
  }
  if (console.json())
    console.result(json);
  else
    console.print(summary(scene, report) + volume);
}

}  // namespace

void check_outputs(const scene::Document& document, const std::string& scene_file,
                   const OutputOptions& outputs, CommandFiles command) {
  if (!outputs.any())
    fail(ErrorKind::usage,
         "nothing to write: give -o FILE, --preview PICTURE, --report JSON, --save-scene TOML or --dry-run");
  const Files files(outputs);
  if (files.volumes.empty() && (outputs.band || outputs.half || !outputs.values.empty()))
    fail(ErrorKind::usage, "--band, --half and --values are for volumes; give -o FILE.tvol or FILE.vdb");
  const auto none = [&](const auto& can) {
    return std::none_of(files.meshes.begin(), files.meshes.end(), [&](const std::string& file) {
      return can(io::format_of(file, {io::Ability::write_mesh}));
    });
  };
  if (outputs.texture && none([](const io::FormatType& f) { return f.texture; }))
    fail(ErrorKind::usage,
         "--texture is for meshes that hold texture coordinates; give -o FILE.glb or FILE.obj");
  if (outputs.world_coordinates && none([](const io::FormatType& f) { return f.world; }))
    fail(ErrorKind::usage,
         "--world-coordinates is for meshes that hold doubles; give -o FILE.ply or FILE.obj");
  if (outputs.float_colors && none([](const io::FormatType& f) { return f.float_colors; }))
    fail(ErrorKind::usage, "--float-colors is for GLB; give -o FILE.glb");
  if (!outputs.up.empty() &&
      none([&](const io::FormatType& f) { return f.ups.find(outputs.up) != std::string::npos; }))
    fail(ErrorKind::usage, "--up {}: no mesh to write can have it; give -o FILE.obj, FILE.ply or FILE.stl",
         outputs.up);
  if (!outputs.preview.empty()) io::format_of(outputs.preview, io::Ability::write_image);
  const bool tiled = outputs.tiles.value_or(1) > 1;
  if (tiled && !files.volumes.empty())
    fail(ErrorKind::usage, "{}: a volume is written as a whole; leave out --tiles", files.volumes.front());
  if (tiled && !outputs.preview.empty())
    fail(ErrorKind::usage, "--preview needs the whole mesh at once; leave out --tiles, or use tafoni render");

  if (!outputs.save_scene.empty() && !is_scene_file(outputs.save_scene))
    fail(ErrorKind::usage, "{}: a scene file must end in .toml", outputs.save_scene);
  for (const fs::path& input : inputs_of(document)) command.reads(input);
  // The scene may be saved to where it came from, but nothing else may be written there.
  if (scene_file.empty() || outputs.save_scene.empty() || !same_file(scene_file, outputs.save_scene))
    command.reads(scene_file);
  command.writes(outputs.save_scene);
  for (const std::string& file : outputs.files)
    tiled ? command.writes_tiles(file, *outputs.tiles) : command.writes(file);
  command.writes(outputs.preview);
  command.writes(outputs.report);
}

void run_scene(const scene::Document& document, const std::string& scene_file, const OutputOptions& outputs,
               Console& console) {
  check_outputs(document, scene_file, outputs);
  std::vector<fs::path> written;
  if (outputs.builds() || outputs.dry_run) {
    const scene::BuiltScene scene = scene::build(document, console);
    if (outputs.dry_run) return print_cost(scene, work_of(scene, outputs), console);
    make_outputs(scene, outputs, written, console);
  }
  if (!outputs.save_scene.empty()) {
    scene::save_copy(document, outputs.save_scene, console);
    written.emplace_back(outputs.save_scene);
  }
  if (!console.json()) {
    for (const fs::path& path : written) console.print(file_line(path));
  } else if (!outputs.builds()) {
    console.result(json_text({{"files", {outputs.save_scene}}}));
  }
}

}  // namespace tafoni::cli
