// Samples a built scene, or takes a grid as it is, after an estimate of what that will take: intervals and a
// few samples tell which chunks hold surface.

#include "tafoni/runtime/impl/ground.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/io/format.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/products/volume_scene.h"
#include "tafoni/volume/sample.h"

namespace tafoni::runtime::impl {
namespace {

using volume::GridFrame;
using volume::ScalarGrid;

/// Bytes of mesh, polygons and what the mesher keeps, of a chunk with surface; measured on terrains.
constexpr double mesh_bytes = 130e3;

void check(const DestructibleTerrainSettings& s) {
  for (const double v : {s.voxel, s.band, s.above, s.below, s.floor.value_or(0)})
    if (!(v >= 0) || !std::isfinite(v))
      fail(ErrorKind::usage,
           "a terrain's voxel, band, above, below and floor are lengths in metres, 0 or more, not {}", v);
}

/// The z of the lowest sample in rock of a chunk, if it is less than `best`; else that.
int lowest_rock(const ScalarGrid& grid, Vec3i chunk, int best) {
  constexpr int side = ScalarGrid::chunk_samples;
  const Vec3i first{chunk.x * side, chunk.y * side, chunk.z * side}, n = grid.frame().size;
  float value = 0;
  if (grid.uniform(chunk, &value)) return value > 0 ? std::min(best, first.z) : best;
  std::vector<float> layer(side * side);
  for (int z = first.z; z < std::min({first.z + side, n.z, best}); ++z) {
    const volume::SampleBox box{{first.x, first.y, z},
                                {std::min(first.x + side, n.x) - 1, std::min(first.y + side, n.y) - 1, z}};
    grid.read(box, layer.data());
    if (std::any_of(layer.begin(), layer.begin() + box.count(), [](float v) { return v > 0; })) return z;
  }
  return best;
}

/// Where the floor ends that nothing digs.
int first_layer_of(const ScalarGrid& grid, const DestructibleTerrainSettings& settings) {
  const GridFrame& frame = grid.frame();
  const double height = settings.floor.value_or(2 * frame.spacing);
  if (height == 0) return 0;
  const Vec3i chunks = grid.chunks();
  int lowest = frame.size.z;
  for (int c = 0; c < chunks.z && lowest == frame.size.z; ++c)
    for (int b = 0; b < chunks.y; ++b)
      for (int a = 0; a < chunks.x; ++a) lowest = lowest_rock(grid, {a, b, c}, lowest);
  return static_cast<int>(std::min<double>(frame.size.z, lowest + std::ceil(height / frame.spacing - 1e-9)));
}

constexpr double chunk_samples =
    ScalarGrid::chunk_samples * ScalarGrid::chunk_samples * ScalarGrid::chunk_samples;

double sample_bytes(volume::Precision precision) {
  return precision == volume::Precision::single ? 4 : 2;
}

/// The same from an estimate of how many chunks have surface.
void check_estimate(double chunks, const GridFrame& frame, volume::Precision precision,
                    const DestructibleTerrainSettings& settings) {
  constexpr double side = ScalarGrid::chunk_samples;
  const double all =
      std::ceil(frame.size.x / side) * std::ceil(frame.size.y / side) * std::ceil(frame.size.z / side);
  const double bytes = chunks * (chunk_samples * sample_bytes(precision) + mesh_bytes) + all * 64;
  check_memory(static_cast<std::uint64_t>(bytes), frame, settings);
}

/// Whether not all samples of a chunk are beyond the band on one side, by its interval and then by every
/// eighth sample: intervals are wide at cliffs.
bool mixed(const field::CompiledField& field, const GridFrame& frame, double band, Vec3i first) {
  constexpr int side = ScalarGrid::chunk_samples, step = 8;
  const auto limit = static_cast<float>(band);
  const Interval range =
      field.interval({frame.position(first), frame.position(first + Vec3i{side - 1, side - 1, side - 1})});
  if (range.lo >= limit || range.hi <= -limit) return false;
  std::vector<Vec3d> points;
  for (int z = 0; z <= side; z += step)
    for (int y = 0; y <= side; y += step)
      for (int x = 0; x <= side; x += step) points.push_back(frame.position(first + Vec3i{x, y, z}));
  std::vector<float> values(points.size());
  field.values(points, values);
  const auto [lowest, highest] = std::ranges::minmax(values);
  return lowest < limit && -limit < highest;
}

/// About how many chunks of samples are not one value, from a thousand columns of chunks at most.
double chunks_with_surface(const field::CompiledField& field, const GridFrame& frame, double band,
                           Progress& progress) {
  constexpr int side = ScalarGrid::chunk_samples;
  const Vec3i n{(frame.size.x - 1) / side + 1, (frame.size.y - 1) / side + 1, (frame.size.z - 1) / side + 1};
  std::atomic<std::int64_t> count{0};
  const std::int64_t all = std::int64_t{n.x} * n.y, columns = std::min<std::int64_t>(all, 1024);
  progress.begin("size", columns, "columns");
  parallel_for(
      columns,
      [&](std::int64_t index) {
        const std::int64_t i = index * all / columns;
        std::int64_t here = 0;
        for (int c = 0; c < n.z; ++c)
          here += mixed(field, frame, band,
                        {static_cast<int>(i % n.x) * side, static_cast<int>(i / n.x) * side, c * side});
        count += here;
      },
      progress);
  progress.end();
  return static_cast<double>(count) * static_cast<double>(all) / static_cast<double>(columns);
}

}  // namespace

std::uint64_t bytes_of(const ScalarGrid& grid, std::uint64_t full_chunks) {
  const Vec3i n = grid.chunks();
  constexpr std::uint64_t slots = 64;  // of a chunk in the tables of grids and snapshots
  return std::uint64_t(n.x) * n.y * n.z * slots +
         full_chunks * static_cast<std::uint64_t>(chunk_samples * sample_bytes(grid.precision()));
}

std::uint64_t bytes_of(const surface::GridChunkMesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  constexpr std::uint64_t kept_by_mesher = 25000, index = 45;  // a chunk, a triangle: see their headers
  const surface::VoxelPolygons& p = mesh.polygons;
  return kept_by_mesher + (mesh.positions.size() + mesh.normals.size() + p.voxels.size()) * sizeof(Vec3f) +
         mesh.triangles.size() * (sizeof(mesh.triangles[0]) + index) +
         (p.first.size() + p.begin.size() + p.corners.size()) * sizeof(std::uint32_t);
}

void check_memory(std::uint64_t bytes, const GridFrame& frame, const DestructibleTerrainSettings& settings) {
  if (bytes > settings.memory)
    fail(
        ErrorKind::usage,
        "a terrain of {} x {} x {} samples at {:g} m takes about {:.1f} GB, more than the {:.1f} GB allowed: "
        "use a coarser voxel, half precision or a window of the terrain",
        frame.size.x, frame.size.y, frame.size.z, frame.spacing, static_cast<double>(bytes) * 1e-9,
        static_cast<double>(settings.memory) * 1e-9);
}

Ground ground_of(const scene::BuiltScene& scene, const DestructibleTerrainSettings& settings,
                 Progress& progress) {
  check(settings);
  const double voxel = settings.voxel > 0 ? settings.voxel : scene.voxel;
  const double band = settings.band > 0 ? settings.band : 4 * voxel;
  const surface::Boundary boundary = settings.boundary.value_or(scene.boundary());
  const field::CompiledField field = scene.field_for(boundary);
  Box3d box = field.bounds();
  if (box.empty())
    fail(ErrorKind::usage, "the scene has no surface, so that there is nothing to stand on or dig in");
  if (boundary == surface::Boundary::open) {
    const Box3d& sides = scene.terrain.box;
    box = {{sides.lo.x, sides.lo.y, box.lo.z - settings.below}, {sides.hi.x, sides.hi.y, box.hi.z}};
  } else {
    box = box.grown(2 * voxel);
  }
  box.hi.z += settings.above;
  const GridFrame frame = volume::frame_over(box, voxel);
  check_estimate(chunks_with_surface(field, frame, band, progress), frame, settings.precision, settings);
  ScalarGrid grid = volume::sample(field, frame, {settings.precision, band}, progress);
  const int first = first_layer_of(grid, settings);
  return {std::move(grid), boundary, {scene.terrain.origin, band, first}};
}

Ground ground_of(ScalarGrid grid, Vec3d origin, const DestructibleTerrainSettings& settings) {
  check(settings);
  check_estimate(static_cast<double>(grid.full_chunks()), grid.frame(), grid.precision(), settings);
  const auto band = static_cast<float>(settings.band);
  if (band > 0)
    grid.edit(grid.samples(), [band](Vec3i, std::span<float> row) {
      for (float& v : row) v = std::clamp(v, -band, band);
    });
  const Interval range = grid.range(grid.frame().box());
  const double most = std::max(std::abs(range.lo), std::abs(range.hi));
  if (!(most > 0)) fail(ErrorKind::usage, "the volume is 0 throughout, so that it has neither rock nor air");
  const int first = first_layer_of(grid, settings);
  return {std::move(grid), settings.boundary.value_or(surface::Boundary::solid), {origin, most, first}};
}

Ground read_ground(const std::filesystem::path& file, const DestructibleTerrainSettings& settings,
                   Progress& progress) {
  if (!io::can(file, io::Ability::read_volume))
    return ground_of(scene::build(scene::open_document(file.string()), progress), settings, progress);
  io::Volume volume = io::read_volume(file, progress);
  return ground_of(std::move(volume.grid), volume.origin, settings);
}

}  // namespace tafoni::runtime::impl
