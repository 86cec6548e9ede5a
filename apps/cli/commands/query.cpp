#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>

#include "command.h"
#include "scene_run.h"
#include <fmt/format.h>

#include "tafoni/core/parallel.h"
#include "tafoni/scene/csv.h"

namespace tafoni::cli {
namespace {

struct Query {
  std::string scene_file, points, output;
  SceneOptions scene;
};

std::vector<Vec3d> read_points(const std::string& path) {
  if (path != "-") return scene::parse_points_csv(scene::read_text(path), path);
  const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
  return scene::parse_points_csv(text, "standard input");
}

void append_row(fmt::memory_buffer& out, bool json, Vec3d p, float f, Vec3f g) {
  // Positions in full, so that those of UTM size stay exact; the field with the digits a float has.
  const auto at = std::back_inserter(out);
  g += Vec3f{};  // turns -0 into 0
  if (json)
    fmt::format_to(at, R"({{"x": {}, "y": {}, "z": {}, "f": {:.9g}, "gradient": [{:.9g}, {:.9g}, {:.9g}]}})",
                   p.x, p.y, p.z, f, g.x, g.y, g.z);
  else
    fmt::format_to(at, "{},{},{},{:.9g},{:.9g},{:.9g},{:.9g}\n", p.x, p.y, p.z, f, g.x, g.y, g.z);
}

int run(const Query& q, Console& console) {
  scene::Document document = open_document(q.scene_file);
  q.scene.apply(document);
  if (!q.output.empty()) {
    std::vector<std::filesystem::path> inputs = inputs_of(document);
    inputs.insert(inputs.end(), {q.scene_file, q.points});
    check_output(q.output, inputs);
  }
  const std::vector<Vec3d> world = read_points(q.points);
  const scene::BuiltScene scene = scene::build(document, console);
  const field::CompiledField field = scene.field_for(scene.boundary());

  std::vector<Vec3d> local(world.size());
  std::transform(world.begin(), world.end(), local.begin(),
                 [&](Vec3d p) { return scene.terrain.to_local(p); });
  std::vector<float> values(world.size());
  std::vector<Vec3f> gradients(world.size());
  parallel_blocks(static_cast<std::int64_t>(world.size()), 4096, [&](std::int64_t begin, std::int64_t end) {
    const auto first = static_cast<std::size_t>(begin), count = static_cast<std::size_t>(end - begin);
    field.gradients(std::span(local).subspan(first, count), std::span(values).subspan(first, count),
                    std::span(gradients).subspan(first, count));
  });

  fmt::memory_buffer out;
  const auto text = [&](std::string_view s) { out.append(s.data(), s.data() + s.size()); };
  text(console.json() ? "[" : "x,y,z,f,gx,gy,gz\n");
  for (std::size_t i = 0; i < world.size(); ++i) {
    if (console.json()) text(i == 0 ? "\n  " : ",\n  ");
    append_row(out, console.json(), world[i], values[i], gradients[i]);
  }
  if (console.json()) text("\n]\n");
  if (q.output.empty())
    console.result({out.data(), out.size()});
  else
    write_file(q.output, {out.data(), out.size()});
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  auto q = std::make_shared<Query>();
  args.positional("SCENE", q->scene_file, "Scene file (.toml), or an elevation model");
  args.text("--points", "CSV", q->points, "Points x,y,z in the scene's CRS; - reads standard input");
  args.text("-o,--output", "CSV", q->output, "File to write; default: stdout");
  q->scene.declare(args);
  return [q](Console& console) {
    if (q->points.empty()) fail(ErrorKind::usage, "query needs --points CSV (or - for standard input)");
    return run(*q, console);
  };
}

}  // namespace

const Command& command_query() {
  static const Command command = {
      "query",
      "Print the field and its gradient at points: f > 0 is rock, f < 0 air, metres near the surface",
      "  tafoni query scene.toml --points points.csv > values.csv\n"
      "  echo 452300.5,5528100.25,120 | tafoni query scene.toml --points -",
      setup};
  return command;
}

}  // namespace tafoni::cli
