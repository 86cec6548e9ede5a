// Some columns of the lattice's chunks are meshed in full and stand for all. Which of them is drawn by how
// much surface a coarser lattice shows in each, so that what is crowded is looked at, and each counts by the
// inverse of its chance.
#include "tafoni/scene/products/predict.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tafoni/field/chunks.h"
#include "tafoni/math/whole.h"
#include "tafoni/mesh/inner/topology.h"
#include "tafoni/mesh/simplify.h"
#include "tafoni/scene/products/mesh_scene.h"

namespace tafoni::scene {
namespace {

namespace prediction {
// Columns that are meshed: a few per cent of error, within a second or two. So many or fewer are all meshed.
constexpr std::size_t samples = 96;
// Among more columns than these, the coarser lattice is too coarse to tell one from the next: they are drawn
// evenly.
constexpr std::size_t weighed = 64 * 64;
// The coarser lattice has so many cells along the longer side at most, and coarser ones by this factor.
constexpr double coarse_cells = 256, coarser = 2;
// Cells about a column that are meshed with it: a simplified triangle is some cells long.
constexpr double margin = 8;
// Of the mean surface in a column: a column in which the coarser lattice shows nothing is looked at, too.
constexpr double floor = 0.1;
// Bytes a triangle before it is simplified, as measured: of the pieces, the mesh gathered from them, and its
// colours.
constexpr double mesh_bytes = 78;
// Of the walls about a small terrain that is left where the lattice cuts its corners.
constexpr double wall_share = 0.9;
constexpr std::uint64_t vertex_bytes = 12 + 12 + 4, triangle_bytes = 12;
}  // namespace prediction

/// The columns of chunks over the terrain, in rows from the south-west.
struct Columns {
  explicit Columns(const BuiltScene& scene) : side(scene.voxel * field::chunk_cells) {
    const Box3d& box = scene.terrain.box;
    west = floor_to(box.lo.x / side), south = floor_to(box.lo.y / side);
    width = floor_to(box.hi.x / side) - west + 1, height = floor_to(box.hi.y / side) - south + 1;
  }
  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  std::size_t at(int col, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(col);
  }
  std::size_t over(double x, double y) const {
    return at(std::clamp(floor_to(x / side) - west, 0, width - 1),
              std::clamp(floor_to(y / side) - south, 0, height - 1));
  }
  /// At a share of the way from west to east and from south to north, both below 1.
  std::size_t in(double x, double y) const { return at(floor_to(x * width), floor_to(y * height)); }
  Box3d box(std::size_t index) const {
    const int col = static_cast<int>(index % static_cast<std::size_t>(width)),
              row = static_cast<int>(index / static_cast<std::size_t>(width));
    const double x = (west + col) * side, y = (south + row) * side;
    return {{x, y, 0}, {x + side, y + side, 0}};
  }

  double side;
  int west = 0, south = 0, width = 0, height = 0;
};

struct Counts {
  double meshed = 0, kept = 0;
};

mesh::Mesh simplified(const BuiltScene& scene, const mesh::Mesh& mesh, Progress& progress) {
  mesh::SimplifySettings settings;
  settings.error = scene.document.scene.simplify;
  return settings.error > 0 && !mesh.triangles.empty() ? mesh::simplify(mesh, settings, progress) : mesh;
}

/// The triangles over the column. Each belongs to that over which it has its middle, so that no column has
/// those of another.
double over_column(const mesh::Mesh& mesh, const Box3d& column) {
  std::int64_t out = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d middle =
        to_double(mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) * (1.0 / 3);
    out += middle.x >= column.lo.x && middle.x < column.hi.x && middle.y >= column.lo.y &&
           middle.y < column.hi.y;
  }
  return static_cast<double>(out);
}

/// The triangles of a simplified mesh over the column, by its vertices: two for each, or one on an open
/// border, as Euler's formula has it. Where little is left, the triangles themselves reach from the column to
/// where the mesh was cut, and would be as many as that has vertices.
double simplified_over_column(const mesh::Mesh& mesh, const Box3d& column) {
  const std::vector<bool> border = mesh::inner::on_border(mesh.triangles, mesh.positions.size());
  double out = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d p = to_double(mesh.positions[v]);
    if (p.x >= column.lo.x && p.x < column.hi.x && p.y >= column.lo.y && p.y < column.hi.y)
      out += border[v] ? 1 : 2;
  }
  return out;
}

/// With a margin about the column: what is cut off there is not simplified, nor known as a fragment. So of
/// fragments that are wider than the margin too much is told.
Counts count_column(const BuiltScene& scene, const field::CompiledField& field,
                    surface::PolygonizeSettings settings, const Box3d& column, Progress& progress) {
  const double margin = prediction::margin * settings.voxel;
  // Walls and base are in the field of a solid, so that a part of either kind is cut out alike.
  const Box3d before =
      settings.boundary == surface::Boundary::open ? settings.region : field.bounds().grown(settings.voxel);
  settings.boundary = surface::Boundary::open;
  settings.region = Box3d::everything();
  settings.region.lo.x = std::max(column.lo.x - margin, before.lo.x);
  settings.region.lo.y = std::max(column.lo.y - margin, before.lo.y);
  settings.region.hi.x = std::min(column.hi.x + margin, before.hi.x);
  settings.region.hi.y = std::min(column.hi.y + margin, before.hi.y);
  if (settings.region.empty()) return {};
  const mesh::Mesh mesh = surface::polygonize(field, settings, progress);
  const double meshed = over_column(mesh, column);
  if (!(scene.document.scene.simplify > 0)) return {meshed, meshed};
  return {.meshed = meshed, .kept = simplified_over_column(simplified(scene, mesh, progress), column)};
}

/// How much surface the coarser lattice shows in each column.
std::vector<double> weights_of(const BuiltScene& scene, const field::CompiledField& field,
                               const Columns& columns, Progress& progress) {
  const Vec3d size = scene.terrain.box.size();
  const double voxel =
      std::max(prediction::coarser * scene.voxel, std::max(size.x, size.y) / prediction::coarse_cells);
  auto settings = polygonize_settings(scene, voxel);
  settings.normals = false;
  settings.min_fragment_volume = 0;
  const mesh::Mesh coarse = surface::polygonize(field, settings, progress);
  std::vector<double> out(columns.size(), prediction::floor * static_cast<double>(coarse.triangles.size()) /
                                              static_cast<double>(columns.size()));
  for (const auto& t : coarse.triangles) {
    const Vec3f p = coarse.positions[t[0]];
    out[columns.over(p.x, p.y)] += 1;
  }
  return out;
}

/// A column that is meshed, and how many it stands for.
struct Draw {
  std::size_t column = 0;
  double times = 1;
};

std::vector<Draw> draw_by_weight(const std::vector<double>& weights) {
  double all = 0;
  for (const double w : weights) all += w;
  std::vector<Draw> out;
  if (!(all > 0)) return out;
  const double step = all / prediction::samples;
  double covered = 0, next = step / 2;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    covered += weights[i];
    if (covered < next) continue;
    // What holds more than a step is drawn more than once.
    const double draws = std::floor((covered - next) / step) + 1;
    next += draws * step;
    out.push_back({i, draws * step / weights[i]});
  }
  return out;
}

/// At places that fill the rectangle evenly: multiples of the inverse powers of the plastic number.
std::vector<Draw> draw_evenly(const Columns& columns) {
  constexpr double x_step = 0.7548776662466927, y_step = 0.5698402909980532;
  const double times = static_cast<double>(columns.size()) / prediction::samples;
  std::vector<Draw> out;
  for (std::size_t k = 0; k < prediction::samples; ++k) {
    const auto part = [&](double step) { return std::fmod(0.5 + static_cast<double>(k + 1) * step, 1); };
    out.push_back({columns.in(part(x_step), part(y_step)), times});
  }
  return out;
}

Prediction prediction_of(const BuiltScene& scene, const Counts& counts, int tiles) {
  Prediction p;
  p.voxel = scene.voxel;
  p.meshed = static_cast<std::uint64_t>(counts.meshed);
  p.triangles = static_cast<std::uint64_t>(counts.kept);
  p.vertices = p.triangles / 2;
  p.file_bytes = p.vertices * prediction::vertex_bytes + p.triangles * prediction::triangle_bytes;
  p.memory = static_cast<std::uint64_t>(prediction::mesh_bytes * counts.meshed / (1.0 * tiles * tiles));
  return p;
}

/// A flat surface cuts each column of cells once, which makes two triangles; a base does so again.
double level_triangles(const BuiltScene& scene) {
  const Vec3d size = scene.terrain.box.size();
  return (scene.boundary() == surface::Boundary::solid ? 4 : 2) * size.x * size.y /
         (scene.voxel * scene.voxel);
}

/// Of the walls, from the lowest ground down to the base; where they meet, corners are cut.
double wall_triangles(const BuiltScene& scene) {
  if (scene.boundary() != surface::Boundary::solid) return 0;
  const Vec3d size = scene.terrain.box.size();
  const double height = scene.settings.influence + scene.document.terrain.depth;
  return prediction::wall_share * 2 * 2 * (size.x + size.y) * height / (scene.voxel * scene.voxel);
}

}  // namespace

Prediction least_prediction(const BuiltScene& scene, int tiles) {
  const double triangles = level_triangles(scene) + wall_triangles(scene);
  const bool simple = scene.document.scene.simplify > 0;
  Prediction out = prediction_of(scene, {triangles, simple ? 0 : triangles}, tiles);
  out.share = 0;
  return out;
}

bool is_tall(const BuiltScene& scene) {
  return wall_triangles(scene) > level_triangles(scene);
}

Prediction predict(const BuiltScene& scene, int tiles, Progress& progress) {
  const field::CompiledField field = scene.field_for(scene.boundary());
  auto settings = polygonize_settings(scene, scene.voxel);
  settings.normals = false;
  const Columns columns(scene);
  if (columns.size() <= prediction::samples) {
    const mesh::Mesh mesh = surface::polygonize(field, settings, progress);
    const auto count = [](const mesh::Mesh& m) { return static_cast<double>(m.triangles.size()); };
    return prediction_of(scene, {count(mesh), count(simplified(scene, mesh, progress))}, tiles);
  }
  const std::vector<Draw> draws = columns.size() <= prediction::weighed
                                      ? draw_by_weight(weights_of(scene, field, columns, progress))
                                      : draw_evenly(columns);
  Counts counts;
  for (const Draw& draw : draws) {
    const Counts own = count_column(scene, field, settings, columns.box(draw.column), progress);
    counts.meshed += draw.times * own.meshed;
    counts.kept += draw.times * own.kept;
  }
  Prediction out = prediction_of(scene, counts, tiles);
  out.share = static_cast<double>(draws.size()) / static_cast<double>(columns.size());
  return out;
}

}  // namespace tafoni::scene
