// The report as JSON: the scene's settings, what each layer told, the tree, the mesh, and the seconds of each
// stage.
#include "tafoni/scene/products/report.h"

#include <nlohmann/json.hpp>

#include "tafoni/scene/products/facts.h"

namespace tafoni::scene {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Value& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

Json to_json(Vec3d v) {
  return Json::array({v.x, v.y, v.z});
}

Json layers_json(const BuiltScene& scene) {
  Json out = Json::array();
  for (const LayerResult& layer : scene.layers) {
    Json entry = {{"name", layer.name}, {"type", layer.type}, {"seconds", layer.seconds}};
    if (layer.reused) entry["reused"] = true;
    entry["primitives"] = primitives_of(layer.made);
    for (const landforms::Fact& fact : layer.made.facts) {
      const auto [key, value] = report_entry(fact, scene.terrain.origin);
      entry[key] = to_json(value);
      if (!fact.about.empty()) entry["explained"][key] = fact.about;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

Json mesh_json(const MeshCounts& counts) {
  Json out = {{"vertices", counts.vertices},
              {"triangles", counts.triangles},
              {"components", counts.components},
              {"fragments_removed", counts.fragments_removed},
              {"bubbles_removed", counts.bubbles_removed},
              {"samples_evaluated", counts.samples_evaluated}};
  if (counts.triangles_unsimplified) out["triangles_before_simplification"] = *counts.triangles_unsimplified;
  if (!counts.metrics) return out;
  const mesh::MeshMetrics& m = *counts.metrics;
  out["closed"] = m.closed;
  out["area_m2"] = m.area;
  if (m.closed) out["volume_m3"] = m.volume;
  out["bounds"] = {{"low", to_json(m.bounds.lo)}, {"high", to_json(m.bounds.hi)}};
  return out;
}

MeshCounts counts_of(const MeshResult& result) {
  const surface::PolygonizeStats& s = result.stats;
  MeshCounts out;
  out.vertices = s.vertices;
  out.triangles = s.triangles;
  out.components = s.components - s.fragments_removed - s.bubbles_removed;
  out.fragments_removed = s.fragments_removed;
  out.bubbles_removed = s.bubbles_removed;
  out.samples_evaluated = s.evaluated;
  if (result.simplified.triangles_before > 0) {
    out.triangles_unsimplified = result.simplified.triangles_before;
    out.triangles = result.simplified.triangles_after;
  }
  // Tiles were handed on, so that only their counts are known.
  if (result.mesh.triangles.empty()) return out;
  const mesh::MeshMetrics& m = out.metrics.emplace(mesh::metrics(result.mesh));
  out.vertices = m.vertices;
  out.triangles = m.triangles;
  out.components = m.components;
  return out;
}

/// What the numbers are that every report has.
Json explained(const Json& report) {
  Json out = {
      {"layers.primitives", "Shapes that a layer put into the model: points, tubes, boxes …"},
      {"tree.nodes", "Primitives, operators and elevation models of the model, which the surface is made of"},
      {"tree.primitives", "Primitives of all layers"},
      {"tree.bytes", "Memory of the model, without the elevation model"},
      {"seconds", "Time of each stage, by the clock; colour, write … are stages of their own"}};
  if (!report.contains("mesh")) return out;
  out["mesh.components"] =
      "Pieces of surface that hang together: rock that floats and hollows without a way out, too";
  out["mesh.fragments_removed"] =
      "Floating pieces of rock smaller than scene.min_fragment, which were left out";
  out["mesh.bubbles_removed"] =
      "Hollows without a way out smaller than scene.min_fragment, which were filled";
  out["mesh.samples_evaluated"] = "Values of the model that were computed to find the surface";
  if (report["mesh"].contains("volume_m3"))
    out["mesh.volume_m3"] = "Volume of the rock down to the base, whose elevation is terrain.domain.low";
  return out;
}

}  // namespace

Report::Report(const BuiltScene& scene, const MeshResult* result, Seconds after)
    : scene_(scene), result_(result), after_(std::move(after)) {
  if (result) mesh_ = counts_of(*result);
}

std::string Report::json(std::span<const std::string> warnings) const {
  const BuiltScene& scene = scene_;
  const Document& d = scene.document;
  const terrain::Terrain& t = scene.terrain;
  Json out;
  out["version"] = version();
  out["seed"] = d.scene.seed;
  out["voxel_m"] = scene.voxel;
  out["boundary"] = d.scene.boundary;
  out["terrain"] = {
      {"source", d.terrain.source.empty() ? d.terrain.generator : d.terrain.source},
      {"width", t.heights->width()},
      {"height", t.heights->height()},
      {"pixel_m", Json::array({t.heights->placement.dx, t.heights->placement.dy})},
      {"influence_m", scene.settings.influence},
      {"amplitude_m", scene.settings.amplitude},
      {"origin", to_json(t.origin)},
      {"domain", {{"low", to_json(t.to_world(t.box.lo))}, {"high", to_json(t.to_world(t.box.hi))}}},
      {"crs", scene.crs}};
  out["layers"] = layers_json(scene);
  const field::TreeStats stats = field::stats(scene.tree(scene.boundary()));
  out["tree"] = {{"nodes", stats.nodes}, {"primitives", stats.primitives}, {"bytes", stats.bytes}};
  if (mesh_) out["mesh"] = mesh_json(*mesh_);
  Json seconds = Json::object();
  for (const auto& [name, value] : scene.seconds)
    seconds[name] = (seconds.contains(name) ? seconds[name].get<double>() : 0.0) + value;
  if (result_) {
    seconds["compile"] = result_->compile_seconds;
    seconds["polygonize"] = result_->polygonize_seconds;
    seconds["colour"] = result_->colour_seconds;
    if (result_->simplify_seconds > 0) seconds["simplify"] = result_->simplify_seconds;
  }
  for (const auto& [name, value] : after_) seconds[name] = value;
  out["seconds"] = seconds;
  out["warnings"] = warnings;
  out["explained"] = explained(out);
  // Text that came from files need not be UTF-8, which JSON must be: what is not is replaced.
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tafoni::scene
