#include "tafoni/scene/products/sgm.h"

#include <algorithm>
#include <chrono>

#include "tafoni/core/error.h"
#include "tafoni/mesh/metrics.h"

namespace tafoni::scene {
namespace {

constexpr std::string_view kind = "grammar-cave";

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

const LayerResult& find(const BuiltScene& scene, const std::string& name) {
  for (const LayerResult& layer : scene.layers)
    if (layer.type == kind && (name.empty() || layer.name == name || layer.type == name)) {
      if (!layer.made.reshape) fail(ErrorKind::usage, "the layer \"{}\" made no cave to measure", layer.name);
      return layer;
    }
  if (name.empty()) fail(ErrorKind::usage, "the scene has no {} layer to measure; give a mesh", kind);
  fail(ErrorKind::usage, "the scene has no {} layer \"{}\"", kind, name);
}

template <class T>
T fact(const LayerResult& layer, std::string_view name) {
  for (const auto& [key, value] : layer.made.report)
    if (key == name) return std::get<T>(value);
  fail(ErrorKind::internal, "the layer \"{}\" does not report its {}", layer.name, name);
}

Vec3d place(const BuiltScene& scene, const std::vector<double>& world) {
  return Vec3d{world.at(0), world.at(1), world.at(2)} - scene.terrain.origin;
}

SgmMeasures measured(const mesh::Mesh& mesh) {
  SgmMeasures out;
  const mesh::MeshMetrics m = mesh::metrics(mesh);
  out.area = m.area;
  out.volume = m.volume;
  out.closed = m.closed;
  out.triangles = m.triangles;
  out.convexity = mesh::convexity(mesh);
  return out;
}

}  // namespace

SgmMeasures sgm_measures(const mesh::Mesh& mesh, double edge, Progress& progress) {
  SgmMeasures out = measured(mesh);
  if (out.closed) out.cubes = mesh::inside_cubes(mesh, edge, progress);
  out.cubes.edge = edge;
  return out;
}

SgmSolid sgm_solid(const BuiltScene& scene, const std::string& name) {
  const LayerResult& layer = find(scene, name);
  SgmSolid out;
  out.box.expand(place(scene, fact<std::vector<double>>(layer, "low")));
  out.box.expand(place(scene, fact<std::vector<double>>(layer, "high")));
  out.box = out.box.grown(0.01);
  // What it adds where all is air, or else what it takes from where all is rock.
  constexpr float far = 1e6f;
  out.tree = layer.made.reshape(field::constant(-far));
  if (field::compile(out.tree).interval(out.box).hi > 0) return out;
  out.tree = layer.made.reshape(field::constant(far));
  if (field::compile(out.tree).value(out.box.grown(1).lo) > 0)
    out.tree = field::subtract(field::constant(far), out.tree);
  return out;
}

std::vector<SgmMeasures> sgm_measures(const BuiltScene& scene, const std::string& name,
                                      std::span<const int> details, Progress& progress) {
  const LayerResult& layer = find(scene, name);
  const SgmSolid solid = sgm_solid(scene, name);
  const int own = static_cast<int>(fact<std::int64_t>(layer, "detail"));
  if (details.empty()) details = {&own, 1};
  std::vector<SgmMeasures> out;
  for (const int detail : details) {
    surface::PolygonizeSettings settings;
    settings.voxel = fact<double>(layer, "size_m") / detail;
    settings.region = solid.box.grown(2 * settings.voxel);
    const double start = now();
    const field::CompiledField field = field::compile(solid.tree);
    const mesh::Mesh mesh = surface::polygonize(field, settings, progress);
    const double seconds = now() - start + layer.seconds;
    SgmMeasures row = measured(mesh);
    row.detail = detail;
    row.cubes = mesh::inside_cubes(field, solid.box, settings.voxel, progress);
    row.elements = fact<std::int64_t>(layer, "elements");
    row.productions = fact<std::int64_t>(layer, "productions");
    row.seconds = seconds;
    out.push_back(row);
  }
  return out;
}

}  // namespace tafoni::scene
