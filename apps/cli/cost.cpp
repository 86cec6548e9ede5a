// The scene is built already, so that the memory of that is known; what comes after it is predicted.
#include "cost.h"

#include <algorithm>

#include "memory.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/math/whole.h"
#include "tafoni/scene/products/predict.h"
#include "tafoni/scene/products/volume_scene.h"

namespace tafoni::cli {
namespace {

// Bytes a triangle while a picture of it is made, as measured.
constexpr double picture_bytes = 105;
// Bytes a pixel while a picture is made: of its light, what guides the removal of grain, and the image.
constexpr double pixel_bytes = 80;
// Bytes of a volume in memory for each within its band, as measured.
constexpr double chunk_share = 4;
// A build is looked at closely from this part of what is free: no scene has so many times the surface of a
// flat terrain.
constexpr double near_share = 0.05;
// Columns of cells in which the surface of a volume is looked for.
constexpr double most_looked_at = 1e8;
// A prediction of a file may be that much too great, as it is packed.
constexpr double disks = 10;

struct Cost {
  scene::Prediction mesh;
  Vec3i samples{0, 0, 0};
  std::uint64_t volume_bytes = 0;
  std::uint64_t memory = 0;
};

std::uint64_t memory_of(const Work& work, const Cost& cost, const MemoryUse& scene) {
  double more = 0;
  if (work.meshed) more = static_cast<double>(cost.mesh.memory);
  if (work.picture)
    more += picture_bytes * static_cast<double>(cost.mesh.triangles) + pixel_bytes * work.pixels;
  // A volume is held by chunks, of which those near the surface hold more than the band.
  const double all = 1.0 * cost.samples.x * cost.samples.y * cost.samples.z * (work.half ? 2 : 4);
  more = std::max(more, std::min(all, chunk_share * static_cast<double>(cost.volume_bytes)));
  return std::max(scene.peak, scene.now + static_cast<std::uint64_t>(more));
}

/// Of a volume; without looking for the surface where even that would take long.
Vec3i samples_of(const scene::BuiltScene& scene, const Work& work, Console& console) {
  const Vec3d size = scene.terrain.box.size() * (1 / scene.voxel);
  if (size.x * size.y < most_looked_at)
    return scene::volume_frame(scene, work.band, work.distance ? surface::Boundary::solid : scene.boundary(),
                               console)
        .size;
  return {ceil_to(size.x), ceil_to(size.y), ceil_to(size.z)};
}

Cost cost_of(const scene::BuiltScene& scene, const Work& work, Console& console) {
  const MemoryUse use = memory_use();
  Cost cost;
  // Where the whole cannot fit by far, nor that of a tall scene, even the part that is looked at takes long.
  const auto least = static_cast<double>(scene::least_prediction(scene).memory),
             most = static_cast<double>(free_memory());
  const bool hopeless = near_share * least > most || (scene::is_tall(scene) && least > most);
  cost.mesh =
      hopeless ? scene::least_prediction(scene, work.tiles) : scene::predict(scene, work.tiles, console);
  if (!work.volumes.empty()) {
    const Vec3i n = cost.samples = samples_of(scene, work, console);
    // Two triangles a cell of the surface; what is within the band of it is stored sample by sample.
    const double all = static_cast<double>(n.x) * n.y * n.z;
    const double near = work.band > 0 ? static_cast<double>(cost.mesh.meshed) * work.band / scene.voxel : all;
    cost.volume_bytes = static_cast<std::uint64_t>(std::min(near, all)) * (work.half ? 2 : 4);
  }
  cost.memory = memory_of(work, cost, use);
  return cost;
}

}  // namespace

void print_cost(const scene::BuiltScene& scene, const Work& work, Console& console) {
  const Cost cost = cost_of(scene, work, console);
  const scene::Prediction& p = cost.mesh;
  const Vec3i n = cost.samples;
  if (console.json()) {
    nlohmann::ordered_json json = {
        {"voxel_m", p.voxel},          {"triangles", p.triangles},           {"vertices", p.vertices},
        {"memory_bytes", cost.memory}, {"free_memory_bytes", free_memory()}, {"glb_bytes", p.file_bytes}};
    if (cost.volume_bytes > 0) json["samples"] = {n.x, n.y, n.z}, json["volume_bytes"] = cost.volume_bytes;
    console.result(json_text(json));
    return;
  }
  const std::string judged =
      p.share > 0 ? fmt::format("{:.3g} % of the terrain", 100 * p.share) : "its size alone, and at least";
  std::string out = fmt::format(
      "at a voxel of {:g} m, judged from {}:\n"
      "triangles  about {}\nmemory     about {}, {} are free\n",
      p.voxel, judged, with_commas(p.triangles), as_bytes(cost.memory), as_bytes(free_memory()));
  if (work.volumes.empty() || !work.meshes.empty())
    out += fmt::format("GLB file   about {}\n", as_bytes(p.file_bytes));
  if (cost.volume_bytes > 0)
    out += fmt::format("volume     {} x {} x {} samples, about {} before it is packed\n", n.x, n.y, n.z,
                       as_bytes(cost.volume_bytes));
  console.result(out);
}

void check_cost(const scene::BuiltScene& scene, const Work& work, Console& console) {
  const std::uint64_t memory = free_memory();
  std::uint64_t disk = ~std::uint64_t{0};
  for (const auto* files : {&work.meshes, &work.volumes})
    for (const std::string& file : *files) disk = std::min(disk, free_disk(file));
  const auto part = [](std::uint64_t bytes) {
    return static_cast<std::uint64_t>(near_share * static_cast<double>(bytes));
  };
  const scene::Prediction least = scene::least_prediction(scene, work.tiles);
  const auto film = static_cast<std::uint64_t>(pixel_bytes * work.pixels);
  if (least.memory + film < part(memory) && least.file_bytes < part(disk)) return;
  const MemoryUse use = memory_use();
  const Cost cost = cost_of(scene, work, console);
  if (cost.memory > use.now && cost.memory - use.now > memory)
    fail(ErrorKind::usage,
         "the build takes about {} of memory, and {} are free; use a larger --voxel, a smaller --window or "
         "more --tiles, or --force it",
         as_bytes(cost.memory), as_bytes(memory));
  const std::uint64_t bytes =
      std::max(work.meshes.empty() ? 0 : cost.mesh.file_bytes, work.volumes.empty() ? 0 : cost.volume_bytes);
  if (static_cast<double>(bytes) > disks * static_cast<double>(disk))
    fail(
        ErrorKind::usage,
        "the build writes about {}, and {} of the disk are free; use a larger --voxel or a smaller --window, "
        "or --force it",
        as_bytes(bytes), as_bytes(disk));
}

void check_picture(double pixels) {
  const auto bytes = static_cast<std::uint64_t>(pixel_bytes * pixels);
  const std::uint64_t memory = free_memory();
  if (bytes > memory)
    fail(ErrorKind::usage,
         "the picture takes about {} of memory, and {} are free; use a smaller --size, or --force it",
         as_bytes(bytes), as_bytes(memory));
}

}  // namespace tafoni::cli
