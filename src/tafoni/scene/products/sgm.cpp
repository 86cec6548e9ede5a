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

constexpr float far = 1e6f;     // the field where all is rock: beyond any that a layer makes
constexpr double slack = 0.01;  // metres around the box, so that no face of the solid lies in its sides

/// A layer that tells measures, and these.
struct Measured {
  const LayerResult& layer;
  landforms::GrammarCaveMeasures told;
};

/// The first that `name` calls by its name or type, or the first of all where it is empty.
Measured find(const BuiltScene& scene, const std::string& name) {
  const auto called = [&](const LayerResult& layer) {
    return name.empty() || layer.name == name || layer.type == name;
  };
  for (const LayerResult& layer : scene.layers)
    if (const auto told = landforms::grammar_cave_measures(layer.made.facts);
        told && layer.made.reshape && called(layer))
      return {layer, *told};
  if (name.empty())
    fail(ErrorKind::usage, "the scene has no grammar-cave layer to measure, or it made no cave; give a mesh");
  if (std::none_of(scene.layers.begin(), scene.layers.end(), called))
    fail(ErrorKind::usage, "the scene has no grammar-cave layer \"{}\"", name);
  fail(ErrorKind::usage, "the layer \"{}\" made no cave to measure", name);
}

SgmMeasures measure(const mesh::Mesh& mesh) {
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
  SgmMeasures out = measure(mesh);
  if (out.closed) out.cubes = mesh::inside_cubes(mesh, edge, progress);
  out.cubes.edge = edge;
  return out;
}

SgmSolid sgm_solid(const BuiltScene& scene, const std::string& name) {
  const auto [layer, told] = find(scene, name);
  SgmSolid out;
  // The box is rounded as the world positions of a report are, so that both give the same cubes.
  const Box3d box = told.box;
  for (const Vec3d corner : {box.lo, box.hi})
    out.box.expand((corner + scene.terrain.origin) - scene.terrain.origin);
  out.box = out.box.grown(slack);
  // A solid is what the layer adds where all is air, a cave what it takes from where all is rock.
  out.tree = layer.made.reshape(field::constant(-far));
  if (field::compile(out.tree).interval(out.box).hi > 0) return out;
  out.tree = layer.made.reshape(field::constant(far));
  if (field::compile(out.tree).value(out.box.grown(1).lo) > 0)
    out.tree = field::subtract(field::constant(far), out.tree);
  return out;
}

std::vector<SgmMeasures> sgm_measures(const BuiltScene& scene, const std::string& name,
                                      std::span<const int> details, Progress& progress) {
  const auto [layer, told] = find(scene, name);
  const SgmSolid solid = sgm_solid(scene, name);
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
    SgmMeasures row = measure(mesh);
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
