// tafoni query: a scene's field and its surface's distance at points, or answers to rays, spheres and walks,
// read from CSV.
#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "collisions.h"
#include "command.h"
#include "scene_run.h"
#include <fmt/core.h>

#include "tafoni/core/parallel.h"
#include "tafoni/io/csv.h"

namespace tafoni::cli::command_query {
namespace {

struct Query {
  std::string scene_file, points, output;
  std::vector<std::string> questions;  ///< files, by question
  std::optional<std::int64_t> walks;
  std::vector<double> walker;
  bool anywhere = false;
  SceneOptions scene;
};

struct Text {
  std::string text, name;
};
Text read_table(const std::string& path) {
  return {io::read_text(path), path == "-" ? "standard input" : path};
}

std::string row_text(bool json, Vec3d p, float f, Vec3f g, std::optional<double> distance) {
  // Positions in full, so that those of UTM size stay exact; the field with the digits a float has.
  g += Vec3f{};  // turns -0 into 0
  const std::string metres = distance ? fmt::format("{:.9g}", *distance + 0.0) : json ? "null" : "";
  if (json)
    return fmt::format(
        R"({{"x": {}, "y": {}, "z": {}, "f": {:.9g}, "gradient": [{:.9g}, {:.9g}, {:.9g}], "distance": {}}})",
        p.x, p.y, p.z, f, g.x, g.y, g.z, metres);
  return fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{}\n", p.x, p.y, p.z, f, g.x, g.y, g.z, metres);
}

void give(const Query& q, const std::string& text, Console& console) {
  if (q.output.empty())
    console.result(text);
  else
    write_file(q.output, text);
}

/// Metres: from farther off nobody asks how far the surface is.
constexpr double farthest = 1e9;

std::string field_at(const CollisionGround& ground, const std::vector<Vec3d>& world, bool json,
                     Progress& progress) {
  std::vector<Vec3d> local(world.size());
  std::transform(world.begin(), world.end(), local.begin(), [&](Vec3d p) { return p - ground.origin; });
  std::vector<float> values(world.size());
  std::vector<Vec3f> gradients(world.size());
  std::vector<std::optional<double>> distances(world.size());
  progress.begin("points", world.size(), "points");
  parallel_blocks(std::ssize(world), 256, [&](std::int64_t begin, std::int64_t end) {
    const std::size_t first = begin, count = end - begin;
    ground.field->gradients(std::span(local).subspan(first, count), std::span(values).subspan(first, count),
                            std::span(gradients).subspan(first, count));
    for (std::int64_t i = begin; i < end; ++i) {
      progress.advance();
      if (length(local[i]) > farthest) continue;
      const auto near = ground.collider->closest(local[i], std::numeric_limits<double>::infinity());
      if (near) distances[i] = -near->distance;  // positive in rock, as f is
    }
  });
  progress.end();

  std::string out = json ? "[" : "x,y,z,f,gx,gy,gz,distance\n";
  for (std::size_t i = 0; i < world.size(); ++i) {
    progress.check();
    if (json) out += i == 0 ? "\n  " : ",\n  ";
    out += row_text(json, world[i], values[i], gradients[i], distances[i]);
  }
  if (json) out += "\n]\n";
  return out;
}

query::WalkSettings walk_settings(const Query& q) {
  query::WalkSettings settings;
  settings.count = static_cast<int>(*q.walks);
  settings.roofed = !q.anywhere;
  if (q.scene.seed) settings.seed = *q.scene.seed;
  if (q.walker.empty()) return settings;
  settings.walker.radius = q.walker[0], settings.walker.height = q.walker[1],
  settings.walker.step = q.walker[2];
  settings.walker.slope = q.walker[3] * std::numbers::pi / 180;
  return settings;
}

void tell_walks(const Query& q, const CollisionGround& ground, Console& console) {
  const AnswerTable table = walk(ground, walk_settings(q), console);
  double metres = 0, moves = 0, arrived = 0, overlap = 0, depth = 0;
  for (const auto& row : table.rows) {
    metres += *row[6], moves += *row[7], arrived += *row[8];
    overlap = std::max(overlap, *row[9]), depth = std::max(depth, *row[10]);
  }
  if (!q.output.empty()) write_file(q.output, table.text(console.json()));
  if (console.json())
    console.result(fmt::format(
        R"({{"routes": {}, "arrived": {}, "moves": {}, "metres": {:.3f}, "overlap": {:.9g}, "field_depth": {:.9g}}})"
        "\n",
        table.rows.size(), arrived, moves, metres, overlap, depth));
  else
    console.result(
        fmt::format("{} of {} routes completed, {:.0f} moves, {:.0f} m; in the surface by at most {:.6f} m, "
                    "in the field's rock by {:.3f} m\n",
                    arrived, table.rows.size(), moves, metres, overlap, depth));
  check_walks(table);
}

int run(const Query& q, Console& console) {
  const bool mesh = is_mesh_file(q.scene_file);
  std::vector<std::filesystem::path> inputs{q.scene_file};
  for (const std::string& file : q.questions) inputs.emplace_back(file);
  inputs.emplace_back(q.points);
  std::optional<scene::Document> document;
  if (mesh) {
    q.scene.check_unused(q.scene_file, q.walks.has_value());
  } else {
    document = open_document(q.scene_file);
    q.scene.apply(*document);
    const auto more = inputs_of(*document);
    inputs.insert(inputs.end(), more.begin(), more.end());
  }
  if (!q.output.empty()) check_output(q.output, inputs);
  if (!q.points.empty()) {
    if (mesh) fail(ErrorKind::usage, "{}: a mesh has no field; --points needs a scene", q.scene_file);
    const Text table = read_table(q.points);
    const std::vector<Vec3d> points = io::parse_points_csv(table.text, table.name);
    const CollisionGround ground = ground_of_scene(scene::build(*document, console));
    give(q, field_at(ground, points, console.json(), console), console);
    return 0;
  }
  for (std::size_t i = 0; i < q.questions.size(); ++i) {
    if (q.questions[i].empty()) continue;
    const Question& question = all_questions()[i];
    const Text table = read_table(q.questions[i]);
    QuestionTable asked{table.name, {}, {}};
    asked.rows = io::parse_numbers_csv(table.text, table.name, question.columns, &asked.lines);
    const CollisionGround ground =
        mesh ? ground_of_mesh(q.scene_file) : ground_of_scene(scene::build(*document, console));
    give(q, answer(question, ground, asked, console).text(console.json()), console);
    return 0;
  }
  tell_walks(q, mesh ? ground_of_mesh(q.scene_file) : ground_of_scene(scene::build(*document, console)),
             console);
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  auto q = std::make_shared<Query>();
  args.positional("SCENE", q->scene_file,
                  "Path of a scene file (.toml), an elevation model, a volume or a mesh");
  args.text(
      "--points", "CSV", q->points,
      "Points x,y,z in the scene's CRS: at each the field f, which is metres only near untouched ground, its "
      "gradient, and the distance to the surface, metres, positive in rock; - reads standard input");
  q->questions.resize(all_questions().size());
  for (std::size_t i = 0; i < q->questions.size(); ++i)
    args.text(all_questions()[i].flag, "CSV", q->questions[i], all_questions()[i].doc);
  args.integer("--walk", "N", q->walks, 1, 1000000,
               "Walks N random routes and tells how many arrived and how far the walker was within the "
               "surface, which should "
               "be 0; the field's figure beside it is no distance near caves");
  args.numbers("--walker", "RADIUS,HEIGHT,STEP,SLOPE", q->walker, 4,
               "Size of the walker of --walk, the highest step it climbs, in metres, and the steepest ground "
               "it stands "
               "on, in degrees; default: 0.35,1.8,0.45,46");
  args.flag("--anywhere", q->anywhere,
            "Lets the routes of --walk begin in the open, too; default: only under rock");
  args.text("-o,--output", "CSV", q->output, "CSV to write; default: standard output");
  q->scene.declare(args);
  return [q](Console& console) {
    const auto given =
        std::count_if(q->questions.begin(), q->questions.end(), [](const auto& f) { return !f.empty(); }) +
        !q->points.empty() + q->walks.has_value();
    if (given != 1) {
      std::string flags = "--points";
      for (const Question& question : all_questions()) flags += ", " + question.flag;
      fail(ErrorKind::usage, "query needs {} of {} with a CSV (or - for standard input), or --walk N",
           given == 0 ? "one" : "no more than one", flags);
    }
    if (!q->walks && (!q->walker.empty() || q->anywhere))
      fail(ErrorKind::usage, "--walker and --anywhere go with --walk N");
    return run(*q, console);
  };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "query",
                .doc = "Ask at points for the field (f > 0 is rock, f < 0 air) and the surface's distance, "
                       "or the surface: rays, spheres, sweeps and walks"},
      .examples =
          "  tafoni query scene.toml --points points.csv > values.csv\n"
          "  echo 452300.5,5528100.25,120 | tafoni query scene.toml --points -\n"
          "  tafoni query cave.glb --sweeps capsules.csv --json\n"
          "  tafoni query scene.toml --walk 1000 -o routes.csv",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_query
