#include "tafoni/mesh/metrics.h"

#include <memory>

#include "command.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/io/format.h"

namespace tafoni::cli {
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

std::function<int(Console&)> setup(Args& args) {
  auto file = std::make_shared<std::string>();
  args.positional("MESH", *file, "Mesh file");
  return [file](Console& console) {
    const mesh::MeshMetrics m = mesh::metrics(io::read_mesh(*file));
    console.result(console.json() ? json_of(m).dump(2) + "\n" : text_of(m));
    return 0;
  };
}

}  // namespace

const Command& command_metrics() {
  static const Command command = {"metrics", "Measure a mesh: area, volume, genus, bounds, edges",
                                  "  tafoni metrics terrain.glb --json", setup};
  return command;
}

}  // namespace tafoni::cli
