// Meshing a scene: polygonize its tree, colour the vertices by rock, slope and height, simplify; as a whole
// or a tile at a time.
#include "tafoni/scene/products/mesh_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include "tafoni/core/clock.h"
#include "tafoni/core/parallel.h"
#include "tafoni/raster/resample.h"
#include "tafoni/render/inner/palette.h"

namespace tafoni::scene {
namespace {

// Pieces of fewer cells than these are what the lattice makes of thin rock, and are removed with the
// fragments.
constexpr double least_piece = 20;
// Ground counts as roofed, so that nothing grows there, under this much rock or a cell of it, in metres.
constexpr double roof_cover = 1;
// Treads have normals that point up at least so much: to about 60 degrees of slope, where the palette still
// looks for plants.
constexpr float tread = 0.5f;
// Heights over a tread, in metres, at which rock is looked for: close together near the ground, where caves
// are low, and as high as an overhang still keeps off rain and light.
constexpr double overhead[] = {1.5, 3, 5, 8, 13, 21};
// Vertices whose colours one task finds: enough that tasks cost nothing, few enough that all threads get
// some.
constexpr std::int64_t grain = 4096;

/// `tile`: whether the mesh is one of those that meet at their borders.
void finish(const BuiltScene& scene, mesh::Mesh& mesh, bool tile, MeshResult& result, Progress& progress) {
  mesh.origin = scene.terrain.origin;
  double start = now();
  colour(scene, mesh, progress);
  result.colour_seconds += now() - start;
  if (scene.document.scene.simplify <= 0 || mesh.triangles.empty()) return;
  start = now();
  mesh::SimplifySettings settings;
  settings.error = scene.document.scene.simplify;
  settings.seams = tile;
  mesh::SimplifyStats stats;
  mesh = mesh::simplify(mesh, settings, progress, &stats);
  result.simplified.triangles_before += stats.triangles_before;
  result.simplified.triangles_after += stats.triangles_after;
  result.simplified.patches += stats.patches;
  result.simplified.patches_rejected += stats.patches_rejected;
  result.simplify_seconds += now() - start;
}

}  // namespace

surface::PolygonizeSettings polygonize_settings(const BuiltScene& scene, double voxel) {
  surface::PolygonizeSettings settings;
  settings.voxel = voxel;
  settings.boundary = scene.boundary();
  settings.min_fragment_volume = scene.document.scene.min_fragment;
  if (settings.min_fragment_volume > 0)
    settings.min_fragment_volume =
        std::max(settings.min_fragment_volume, least_piece * voxel * voxel * voxel);
  if (settings.boundary == surface::Boundary::solid) return settings;
  const Box3d all = Box3d::everything();
  settings.region = {{scene.terrain.box.lo.x, scene.terrain.box.lo.y, all.lo.z},
                     {scene.terrain.box.hi.x, scene.terrain.box.hi.y, all.hi.z}};
  if (const auto& inside = scene.terrain.inside)
    settings.inside = [inside](double x, double y) { return raster::sample_bilinear(*inside, x, y) > 0; };
  return settings;
}

namespace {

/// Marks treads that have rock overhead, which the heights of a terrain that became a volume do not tell.
class Roofs {
 public:
  explicit Roofs(const BuiltScene& scene) {
    const auto reshapes = [](const LayerResult& layer) { return static_cast<bool>(layer.made.reshape); };
    if (std::any_of(scene.layers.begin(), scene.layers.end(), reshapes)) field_ = field::compile(scene.open);
  }

  void mark(std::vector<render::GroundLook>& points, const std::vector<Vec3d>& local) const {
    if (!field_) return;
    std::vector<Vec3d> asked;
    std::vector<std::size_t> whose;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].roofed || points[i].normal.z < tread) continue;
      whose.push_back(i);
      for (const double up : overhead) asked.push_back(local[i] + Vec3d{0, 0, up});
    }
    std::vector<float> values(asked.size());
    field_->values(asked, values);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] > 0) points[whose[i / std::size(overhead)]].roofed = true;
  }

 private:
  std::optional<field::CompiledField> field_;
};

}  // namespace

void colour(const BuiltScene& scene, mesh::Mesh& mesh, Progress& progress) {
  const auto sea = sea_level(scene.document);
  const Vec3d origin = scene.terrain.origin;
  const raster::Raster& heights = *scene.terrain.heights;
  const Roofs roofs(scene);
  mesh.colors.resize(mesh.positions.size());
  const std::int64_t count = std::ssize(mesh.positions), blocks = (count + grain - 1) / grain;
  progress.begin("colours", blocks);
  parallel_for(
      blocks,
      [&](std::int64_t block) {
        const std::int64_t begin = block * grain;
        const std::int64_t end = std::min(count, (block + 1) * grain);
        std::vector<Vec3d> local;
        for (std::int64_t i = begin; i < end; ++i) local.push_back(to_double(mesh.positions[i]));
        std::vector<float> resistance(local.size());
        scene.geology->resistances(local, resistance);
        std::vector<render::GroundLook> points(local.size());
        for (std::int64_t i = begin; i < end; ++i) {
          const Vec3d at = local[i - begin];
          render::GroundLook& point = points[i - begin];
          point.position = at + origin;
          point.spacing = static_cast<float>(scene.voxel);
          if (!mesh.normals.empty()) point.normal = mesh.normals[i];
          point.plants = static_cast<float>(scene.document.scene.plants);
          point.resistance = resistance[i - begin];
          if (sea) point.height_above_sea = static_cast<float>(point.position.z - *sea);
          const double cover = raster::sample_bilinear(heights, at.x, at.y) - at.z;
          point.roofed = point.normal.z < 0 || cover > std::max(roof_cover, scene.voxel);
        }
        roofs.mark(points, local);
        for (std::int64_t i = begin; i < end; ++i)
          mesh.colors[i] = render::to_rgba8(render::rock_palette(points[i - begin]));
      },
      progress);
  progress.end();
}

void finish_mesh(const BuiltScene& scene, MeshResult& result, Progress& progress) {
  finish(scene, result.mesh, false, result, progress);
}

MeshResult mesh_scene(const BuiltScene& scene, Progress& progress) {
  MeshResult result;
  double start = now();
  const field::CompiledField field = scene.field_for(scene.boundary());
  result.compile_seconds = now() - start;
  start = now();
  result.mesh = surface::polygonize(field, polygonize_settings(scene, scene.voxel), progress, &result.stats);
  result.polygonize_seconds = now() - start;
  finish_mesh(scene, result, progress);
  return result;
}

MeshResult mesh_scene_tiles(const BuiltScene& scene, int tiles, const surface::TileSink& sink,
                            Progress& progress) {
  MeshResult result;
  double start = now();
  const field::CompiledField field = scene.field_for(scene.boundary());
  result.compile_seconds = now() - start;
  auto settings = polygonize_settings(scene, scene.voxel);
  settings.tiles_x = settings.tiles_y = tiles;
  start = now();
  surface::polygonize_tiles(
      field, settings,
      [&](surface::TileIndex index, mesh::Mesh&& tile) {
        const double inner = now();
        finish(scene, tile, true, result, progress);
        sink(index, std::move(tile));
        start += now() - inner;
      },
      progress, &result.stats);
  result.polygonize_seconds = now() - start;
  return result;
}

}  // namespace tafoni::scene
