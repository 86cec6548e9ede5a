// The cave or solid of a grammar layer is taken out of the scene: its change of the tree is applied to
// nothing but air, or to nothing but rock. What it makes there is meshed and counted by cubes.
#include "tafoni/scene/products/sgm.h"

#include <algorithm>

#include "tafoni/core/clock.h"
#include "tafoni/core/error.h"
#include "tafoni/landforms/measures.h"
#include "tafoni/mesh/metrics.h"

namespace tafoni::scene {
namespace {

constexpr std::string_view kind = "grammar-cave";

const LayerResult& find(const BuiltScene& scene, const std::string& name) {
  for (const LayerResult& layer : scene.layers)
    if (layer.type == kind && (name.empty() || layer.name == name || layer.type == name)) {
      if (!layer.made.reshape) fail(ErrorKind::usage, "the layer \"{}\" made no cave to measure", layer.name);
      return layer;
    }
  if (name.empty()) fail(ErrorKind::usage, "the scene has no {} layer to measure; give a mesh", kind);
  fail(ErrorKind::usage, "the scene has no {} layer \"{}\"", kind, name);
}

landforms::GrammarCaveMeasures measures_of(const LayerResult& layer) {
  if (const auto told = landforms::grammar_cave_measures(layer.made.facts)) return *told;
  fail(ErrorKind::internal, "the layer \"{}\" does not tell its measures", layer.name);
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
  // Rounded as the world positions of a report are, so that both give the same cubes.
  const Box3d box = measures_of(layer).box;
  for (const Vec3d corner : {box.lo, box.hi})
    out.box.expand((corner + scene.terrain.origin) - scene.terrain.origin);
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
  const landforms::GrammarCaveMeasures told = measures_of(layer);
  const int own = static_cast<int>(told.detail);
  if (details.empty()) details = {&own, 1};
  std::vector<SgmMeasures> out;
  for (const int detail : details) {
    surface::PolygonizeSettings settings;
    settings.voxel = told.size / detail;
    settings.region = solid.box.grown(2 * settings.voxel);
    const double start = now();
    const field::CompiledField field = field::compile(solid.tree);
    const mesh::Mesh mesh = surface::polygonize(field, settings, progress);
    const double seconds = now() - start + layer.seconds;
    SgmMeasures row = measured(mesh);
    row.detail = detail;
    row.cubes = mesh::inside_cubes(field, solid.box, settings.voxel, progress);
    row.elements = told.elements;
    row.productions = told.productions();
    row.seconds = seconds;
    out.push_back(row);
  }
  return out;
}

}  // namespace tafoni::scene
