// tafoni metrics: the measures of a mesh, or with --sgm those of a grammar cave, as text or JSON.
#include "tafoni/mesh/metrics.h"

#include <charconv>
#include <memory>
#include <optional>

#include "command.h"
#include "cost.h"
#include "scene_run.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/scene/products/sgm.h"

namespace tafoni::cli::command_metrics {
namespace {

nlohmann::ordered_json json_of(const mesh::MeshMetrics& m) {
  return {{"vertices", m.vertices},
          {"triangles", m.triangles},
          {"edges", m.edges},
          {"components", m.components},
          {"boundary_loops", m.boundary_loops},
          {"closed", m.closed},
          {"area", m.area},
          {"volume", m.volume},
          {"euler", m.euler},
          {"genus", m.genus},
          {"low", {m.bounds.lo.x, m.bounds.lo.y, m.bounds.lo.z}},
          {"high", {m.bounds.hi.x, m.bounds.hi.y, m.bounds.hi.z}},
          {"shortest_edge", m.shortest_edge},
          {"mean_edge", m.mean_edge},
          {"longest_edge", m.longest_edge}};
}

std::string text_of(const mesh::MeshMetrics& m) {
  std::string out;
  const auto row = [&](const char* name, const std::string& value) {
    out += fmt::format("{:<15} {}\n", name, value);
  };
  const auto point = [](Vec3d p) { return fmt::format("{:.3f} {:.3f} {:.3f}", p.x, p.y, p.z); };
  row("vertices", with_commas(m.vertices));
  row("triangles", with_commas(m.triangles));
  row("edges", with_commas(m.edges));
  row("components", with_commas(m.components));
  row("boundary loops", with_commas(m.boundary_loops));
  row("closed", m.closed ? "yes" : "no");
  row("area", fmt::format("{:.3f} m2", m.area));
  row("volume",
      fmt::format("{:.3f} m3{}", m.volume, m.closed ? "" : " (of no meaning: the mesh is not closed)"));
  row("Euler number", fmt::format("{}", m.euler));
  row("genus", fmt::format("{:g}", m.genus));
  if (m.triangles > 0) {
    row("low corner", point(m.bounds.lo));
    row("high corner", point(m.bounds.hi));
    row("edges, metres",
        fmt::format("{:.4g} to {:.4g}, mean {:.4g}", m.shortest_edge, m.longest_edge, m.mean_edge));
  }
  return out;
}

struct Options {
  std::string file, details, layer;
  bool sgm = false, csv = false, force = false;
  std::optional<double> cube;
  SceneOptions scene;
};

/// "7", or "1..32".
std::vector<int> details_of(const std::string& text) {
  if (text.empty()) return {};
  const auto number = [&](std::string_view word) {
    int value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || value < 1 || value > 32)
      fail(ErrorKind::usage, "--details {}: write a mesh detail from 1 to 32, or two as in 1..32", text);
    return value;
  };
  const std::size_t dots = text.find("..");
  const int first = number(std::string_view(text).substr(0, dots));
  const int last = dots == text.npos ? first : number(std::string_view(text).substr(dots + 2));
  if (last < first) fail(ErrorKind::usage, "--details {}: the first is greater than the last", text);
  std::vector<int> out;
  for (int detail = first; detail <= last; ++detail) out.push_back(detail);
  return out;
}

using Json = nlohmann::ordered_json;

template <class T>
Json maybe(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of(const scene::SgmMeasures& m) {
  return {{"detail", m.detail > 0 ? Json(m.detail) : Json(nullptr)},
          {"surface_area", m.area},
          {"volume_cubes", m.closed ? Json(m.cubes.volume()) : Json(nullptr)},
          {"volume_mesh", m.closed ? Json(m.volume) : Json(nullptr)},
          {"convexity", m.convexity.factor()},
          {"triangles", m.triangles},
          {"elements", maybe(m.elements)},
          {"productions", maybe(m.productions)},
          {"seconds", maybe(m.seconds)},
          {"cube_edge", m.cubes.edge},
          {"cubes", m.cubes.count},
          {"convex_edges", m.convexity.convex},
          {"concave_edges", m.convexity.concave},
          {"flat_edges", m.convexity.flat},
          {"closed", m.closed}};
}

std::string text_of(const scene::SgmMeasures& m) {
  std::string out;
  const auto row = [&](const char* name, const std::string& value) {
    out += fmt::format("{:<18} {}\n", name, value);
  };
  const std::string unknown = "not known of a mesh";
  if (m.detail > 0) row("mesh detail L_D", fmt::format("{}", m.detail));
  row("surface area", fmt::format("{:.1f} m2", m.area));
  row("volume by cubes", m.closed ? fmt::format("{:.1f} m3, {} cubes of {:.4g} m", m.cubes.volume(),
                                                with_commas(m.cubes.count), m.cubes.edge)
                                  : "none: the mesh is not closed");
  row("volume by mesh", m.closed ? fmt::format("{:.1f} m3", m.volume) : "none: the mesh is not closed");
  row("convexity factor", fmt::format("{:.1f} %, {} convex edges, {} concave, {} flat", m.convexity.factor(),
                                      with_commas(m.convexity.convex), with_commas(m.convexity.concave),
                                      with_commas(m.convexity.flat)));
  row("triangles", with_commas(m.triangles));
  row("elements", m.elements ? fmt::format("{}", *m.elements) : unknown);
  row("productions", m.productions ? fmt::format("{}", *m.productions) : unknown);
  row("time", m.seconds ? as_time(*m.seconds) : unknown);
  return out;
}

std::string csv_of(const std::vector<scene::SgmMeasures>& rows) {
  std::string out;
  for (const scene::SgmMeasures& m : rows) {
    std::string names, values;
    const Json json = json_of(m);
    for (const auto& [name, value] : json.items()) {
      names += (names.empty() ? "" : ",") + name;
      values += (values.empty() ? "" : ",") + (value.is_null() ? std::string() : value.dump());
    }
    if (out.empty()) out = names + "\n";
    out += values + "\n";
  }
  return out;
}

bool is_volume(const std::string& file) {
  return io::can(file, io::Ability::read_volume);
}

/// The mesh in a mesh file, or the surface of a volume.
mesh::Mesh mesh_of(const Options& o, Console& console) {
  if (is_volume(o.file)) {
    scene::Document document = open_document(o.file);
    o.scene.apply(document);
    const scene::BuiltScene scene = scene::build(document, console);
    if (!o.force) check_cost(scene, {}, console);
    return scene::mesh_scene(scene, console).mesh;
  }
  if (is_scene_file(o.file))
    fail(ErrorKind::usage, "{}: only --sgm measures a scene; give a mesh that `tafoni build` made of it",
         o.file);
  if (is_mesh_file(o.file)) o.scene.check_unused(o.file);
  return io::read_mesh(o.file);
}

std::vector<scene::SgmMeasures> sgm(const Options& o, Console& console) {
  if (is_mesh_file(o.file) || is_volume(o.file)) {
    if (!o.details.empty() || !o.layer.empty())
      fail(ErrorKind::usage, "--details and --layer are for scenes; give a mesh or a volume --cube");
    const mesh::Mesh mesh = mesh_of(o, console);
    const Vec3d size = mesh::metrics(mesh).bounds.size();
    return {scene::sgm_measures(mesh, o.cube.value_or(std::max({size.x, size.y, size.z}) / 100), console)};
  }
  if (o.cube) fail(ErrorKind::usage, "--cube is for meshes and volumes; give a scene --details");
  const std::vector<int> details = details_of(o.details);
  scene::Document document = open_document(o.file);
  o.scene.apply(document);
  return scene::sgm_measures(scene::build(document, console), o.layer, details, console);
}

int run_sgm(const Options& o, Console& console) {
  const std::vector<scene::SgmMeasures> rows = sgm(o, console);
  std::string out;
  if (o.csv) {
    out = csv_of(rows);
  } else if (console.json()) {
    Json json = Json::array();
    for (const scene::SgmMeasures& row : rows) json.push_back(json_of(row));
    out = json_text(rows.size() == 1 ? json[0] : json);
  } else {
    for (const scene::SgmMeasures& row : rows) out += (out.empty() ? "" : "\n") + text_of(row);
  }
  console.result(out);
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  auto o = std::make_shared<Options>();
  args.positional(
      "MESH|VOLUME|SCENE", o->file,
      "Path of a mesh or a volume; with --sgm, of a scene file (.toml) or an elevation model, too");
  args.group("Grammar caves");
  args.flag("--sgm", o->sgm,
            "Takes the seven measures of [Zawadzki], of a mesh, a volume or a scene's grammar-cave layer");
  args.text("--details", "L_D", o->details,
            "Mesh detail of a scene's cave from 1 to 32, or a range as in 1..32: more makes smaller "
            "triangles; default: the layer's own");
  args.number("--cube", "M", o->cube, 1e-4, 1e4, "m",
              "Edge of the cubes that are counted in a mesh: less is more exact and takes longer; default: a "
              "hundredth of the longest side");
  args.text("--layer", "NAME", o->layer, "Name of the grammar-cave layer to measure; default: the first");
  args.flag("--csv", o->csv, "Prints a table with a row for each mesh detail");
  o->scene.declare(args);
  args.flag("--force", o->force, "Measures also what seems to take more memory than there is");
  return [o](Console& console) {
    if (o->csv && console.json())
      fail(ErrorKind::usage, "--csv and --json are two forms of the same; give one of them");
    if (o->sgm) return run_sgm(*o, console);
    if (o->csv || o->cube || !o->details.empty() || !o->layer.empty())
      fail(ErrorKind::usage, "--details, --cube, --layer and --csv go with --sgm");
    const mesh::MeshMetrics m = mesh::metrics(mesh_of(*o, console));
    console.result(console.json() ? json_text(json_of(m)) : text_of(m));
    return 0;
  };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "metrics", .doc = "Measure a mesh or a volume: area, volume, genus, bounds, edges"},
      .examples =
          "  tafoni metrics terrain.glb --json\n"
          "  tafoni metrics --sgm scene.toml --details 1..32 --csv",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_metrics
