// tafoni validate: checks a mesh file for what every mesh of the program promises.
#include "tafoni/mesh/validate.h"

#include <memory>

#include "command.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/io/mesh_file.h"

namespace tafoni::cli::command_validate {
namespace {

using Rows = std::vector<std::pair<const char*, std::uint64_t>>;

Rows rows_of(const mesh::MeshReport& r) {
  return {{"vertices", r.vertices},
          {"triangles", r.triangles},
          {"components", r.components},
          {"boundary_edges", r.boundary_edges},
          {"non_manifold_edges", r.non_manifold_edges},
          {"non_manifold_vertices", r.non_manifold_vertices},
          {"orientation_conflicts", r.orientation_conflicts},
          {"degenerate_triangles", r.degenerate_triangles},
          {"duplicate_triangles", r.duplicate_triangles},
          {"slivers", r.slivers},
          {"unused_vertices", r.unused_vertices},
          {"index_errors", r.index_errors},
          {"bad_positions", r.bad_positions},
          {"bad_normals", r.bad_normals},
          {"flipped_normals", r.flipped_normals}};
}

int run(const std::string& file, bool must_be_closed, Console& console) {
  const mesh::MeshReport report = mesh::validate(io::read_mesh(file));
  std::vector<std::string> found = mesh::defects(report);
  if (report.triangles == 0) found.emplace_back("no triangles");
  if (must_be_closed && !report.closed())
    found.push_back(fmt::format("not closed: {} boundary edges", report.boundary_edges));
  const bool valid = found.empty() && report.valid();
  if (console.json()) {
    nlohmann::ordered_json json;
    for (const auto& [name, count] : rows_of(report)) json[name] = count;
    json["closed"] = report.closed();
    json["valid"] = valid;
    json["defects"] = found;
    console.result(json_text(json));
  } else {
    std::string text;
    for (const auto& [name, count] : rows_of(report))
      text += fmt::format("{:<22} {}\n", name, with_commas(count));
    text += fmt::format("{:<22} {}\n", "closed", report.closed() ? "yes" : "no");
    console.print(text);
    console.print(fmt::format("{}: {}\n", file, valid ? "valid" : "defective"));
  }
  if (valid) return 0;
  std::string list;
  for (const std::string& defect : found) list += (list.empty() ? "" : "; ") + defect;
  fail(ErrorKind::invalid, "{}: is defective: {}", file, list);
}

std::function<int(Console&)> setup(Args& args) {
  struct Validate {
    std::string file;
    bool closed = false;
  };
  auto v = std::make_shared<Validate>();
  args.positional("MESH", v->file, "Path of a mesh");
  args.flag("--closed", v->closed, "Counts an open border as a defect, too; default: a mesh may be open");
  return [v](Console& console) { return run(v->file, v->closed, console); };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "validate",
                .doc =
                    "Check a mesh: manifold, oriented, no degenerate triangles; exit code 5 when defective"},
      .examples = "  tafoni validate terrain.glb --closed",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_validate
