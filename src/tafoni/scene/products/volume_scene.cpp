// The surface's highest and lowest elevation are looked for a column of chunks at a time, by the field's
// ranges; the volume's frame holds all between them with a rim, and is sampled.
#include "tafoni/scene/products/volume_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/chunks.h"
#include "tafoni/io/format.h"
#include "tafoni/math/whole.h"
#include "tafoni/surface/distances.h"

namespace tafoni::scene {
namespace {

struct Heights {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
};

/// Narrows the elevations between which the column's surface lies, a brick at a time.
Heights narrow(const field::CompiledField& field, const Box3d& column, double voxel) {
  const double step = voxel * field::brick_cells;
  const auto holds = [&](double from) {
    const Interval range =
        field.interval({{column.lo.x, column.lo.y, from}, {column.hi.x, column.hi.y, from + step}});
    return range.lo <= 0 && range.hi >= 0;
  };
  const auto count = round_to((column.hi.z - column.lo.z) / step);
  int first = 0, last = count - 1;
  while (last >= first && !holds(column.lo.z + last * step)) --last;
  while (first <= last && !holds(column.lo.z + first * step)) ++first;
  if (first > last) return {};
  return {column.lo.z + first * step, column.lo.z + (last + 1) * step};
}

/// Between which elevations the surface lies over the box's x and y.
Heights elevations(const field::CompiledField& field, const Box3d& box, double voxel, Progress& progress) {
  const double size = voxel * field::chunk_cells;
  const auto chunk = [&](double v) { return floor_to(v / size); };
  const int west = chunk(box.lo.x), south = chunk(box.lo.y), columns = chunk(box.hi.x) - west + 1,
            rows = chunk(box.hi.y) - south + 1;
  std::vector<Heights> found(rows);
  progress.begin("looking for the surface", rows, "rows");
  const auto look = [&](std::int64_t row) {
    field::ChunkEvaluator evaluator(field, voxel);
    Heights& own = found[row];
    for (int a = west; a < west + columns; ++a) {
      const int b = south + static_cast<int>(row);
      const auto range = evaluator.column(a, b);
      if (range.first > range.last) continue;
      const Heights column = narrow(
          field,
          {{std::max(a * size, box.lo.x), std::max(b * size, box.lo.y), range.first * size},
           {std::min((a + 1) * size, box.hi.x), std::min((b + 1) * size, box.hi.y), (range.last + 1) * size}},
          voxel);
      own = {std::min(own.lo, column.lo), std::max(own.hi, column.hi)};
      progress.check();
    }
  };
  parallel_for(rows, look, progress);
  progress.end();
  Heights out;
  for (const Heights& row : found) out = {std::min(out.lo, row.lo), std::max(out.hi, row.hi)};
  return out;
}

}  // namespace

volume::GridFrame volume_frame(const BuiltScene& scene, double band, surface::Boundary boundary,
                               Progress& progress) {
  // The frame holds all of the band, so that a level set does not break off within it.
  const double rim = band + 2 * scene.voxel;
  Box3d box = scene.terrain.box;
  if (boundary == surface::Boundary::solid) {
    box.lo -= Vec3d{rim, rim, 0};
    box.hi += Vec3d{rim, rim, 0};
  }
  const Heights z = elevations(scene.field_for(boundary), box, scene.voxel, progress);
  if (!(z.lo < z.hi))
    fail(ErrorKind::input, "the scene has no surface; check the terrain's window, domain and voxel size");
  box.lo.z = z.lo - rim;
  box.hi.z = z.hi + rim;
  return volume::frame_over(box, scene.voxel);
}

io::Volume sample_scene(const BuiltScene& scene, const volume::SampleSettings& settings, Progress& progress) {
  const volume::GridFrame frame = volume_frame(scene, settings.band, scene.boundary(), progress);
  io::Volume out{
      volume::sample(scene.field_for(scene.boundary()), frame, settings, progress), scene.terrain.origin, {}};
  out.metadata.crs = scene.crs;
  return out;
}

double level_set_reach(const BuiltScene& scene, double band) {
  // A little more than three cells, so that rounding to halves leaves three.
  constexpr double least = 3.01;
  if (band == 0 || band > surface::most_distance * scene.voxel)
    fail(ErrorKind::usage,
         "distances are kept within a band of at most {} cells, here {:g} m; give such a --band, or --values "
         "field",
         surface::most_distance, surface::most_distance * scene.voxel);
  return std::max(band, least * scene.voxel);
}

io::Volume level_set(const BuiltScene& scene, const volume::SampleSettings& settings, Progress& progress) {
  constexpr auto closed = surface::Boundary::solid;
  const double reach = level_set_reach(scene, settings.band);
  const volume::ScalarGrid field =
      volume::sample(scene.field_for(closed), volume_frame(scene, reach, closed, progress),
                     {.band = reach, .limit = false}, progress);
  io::Volume out{surface::distances(field, reach, settings.precision, progress), scene.terrain.origin, {}};
  out.metadata.crs = scene.crs;
  return out;
}

Document volume_document(const std::string& path) {
  Document document;
  document.terrain.source = path;
  Layer layer;
  layer.type = "volume";
  layer.values["file"] = path;
  document.layers.push_back(std::move(layer));
  return document;
}

bool is_scene_file(const std::string& path) {
  return std::filesystem::path(path).extension() == ".toml";
}

Document open_document(const std::string& path) {
  if (is_scene_file(path)) return load_scene(path);
  if (io::can(path, io::Ability::read_volume)) return volume_document(path);
  Document document;
  document.terrain.source = path;
  return document;
}

}  // namespace tafoni::scene
