// A row of a CSV is a question to a collider: a ray, a sphere, the nearest point, a walk. Rows are answered
// in parallel and printed in their order.
#include "collisions.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/query/field_collider.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/scene/products/mesh_scene.h"

namespace tafoni::cli {
namespace {

using Answer = std::vector<std::optional<double>>;

/// Metres that a walker may be in the surface's triangles.
constexpr double allowed_overlap = 1e-4;
constexpr std::size_t arrived_column = 8, overlap_column = 9;

Vec3d vec(const std::vector<double>& row, std::size_t at) {
  return {row[at], row[at + 1], row[at + 2]};
}

void append(Answer& out, Vec3d v) {
  out.insert(out.end(), {v.x, v.y, v.z});
}

Answer ask_ray(const query::Collider& ground, const std::vector<double>& row) {
  const auto hit = ground.ray(vec(row, 0), vec(row, 3), row[6]);
  if (!hit) return Answer(8);
  Answer out{hit->distance};
  append(out, hit->point);
  append(out, hit->normal);
  out.push_back(hit->from_rock);
  return out;
}

Answer ask_sphere(const query::Collider& ground, const std::vector<double>& row) {
  const auto contact = ground.contact(query::Sphere{vec(row, 0), row[3]});
  if (!contact) return Answer{0, {}, {}, {}, {}, {}, {}};
  Answer out{contact->depth};
  append(out, contact->point);
  append(out, contact->normal);
  return out;
}

Answer ask_closest(const query::Collider& ground, const std::vector<double>& row) {
  const auto near = ground.closest(vec(row, 0), row[3]);
  if (!near) return Answer(7);
  Answer out{near->distance};
  append(out, near->point);
  append(out, near->normal);
  return out;
}

Answer ask_sweep(const query::Collider& ground, const std::vector<double>& row) {
  const Vec3d foot = vec(row, 0);
  if (!(row[4] >= 2 * row[3]))
    fail(ErrorKind::usage, "a height of {} m is less than two radii of {} m: a sphere's is just that", row[4],
         row[3]);
  const query::Capsule shape(foot + Vec3d{0, 0, row[3]}, foot + Vec3d{0, 0, row[4] - row[3]}, row[3]);
  const auto hit = ground.sweep(shape, vec(row, 5));
  if (!hit) return Answer(8);
  Answer out{hit->time, hit->depth};
  append(out, hit->point);
  append(out, hit->normal);
  return out;
}

}  // namespace

const std::vector<Question>& all_questions() {
  static const std::vector<std::string> surface{"px", "py", "pz", "nx", "ny", "nz"};
  const auto with = [&](std::vector<std::string> first, std::vector<std::string> last = {}) {
    first.insert(first.end(), surface.begin(), surface.end());
    first.insert(first.end(), last.begin(), last.end());
    return first;
  };
  static const std::vector<Question> questions = {
      {"--rays",
       "Rays x,y,z,dx,dy,dz,distance: where each first crosses the surface",
       {"x", "y", "z", "dx", "dy", "dz", "distance"},
       with({"hit"}, {"from_rock"}),
       &ask_ray,
       1},
      {"--spheres",
       "Spheres x,y,z,radius: how deep each is in rock, and which way is out",
       {"x", "y", "z", "radius"},
       with({"depth"}),
       &ask_sphere,
       1},
      {"--closest",
       "Points x,y,z,distance: the surface nearest to each, no farther than the distance; the signed "
       "distance is below 0 in rock",
       {"x", "y", "z", "distance"},
       with({"signed_distance"}),
       &ask_closest,
       1},
      {"--sweeps",
       "Upright capsules x,y,z (the lowest point),radius,height and a motion dx,dy,dz: the first contact",
       {"x", "y", "z", "radius", "height", "dx", "dy", "dz"},
       with({"time", "depth"}),
       &ask_sweep,
       2},
  };
  return questions;
}

CollisionGround ground_of_scene(const scene::BuiltScene& scene) {
  const field::CompiledField field = scene.field_for(scene.boundary());
  const Box3d region = scene::polygonize_settings(scene, scene.voxel).region;
  return {std::make_unique<query::FieldCollider>(
              field, query::FieldSettings{.voxel = scene.voxel, .region = region}),
          scene.terrain.origin, field};
}

CollisionGround ground_of_mesh(const std::string& path) {
  const mesh::Mesh mesh = io::read_mesh(path);
  return {of_file(path, [&] { return std::make_unique<query::MeshCollider>(mesh); }), mesh.origin, {}};
}

std::string AnswerTable::text(bool json) const {
  std::string out;
  for (std::size_t c = 0; !json && c < columns.size(); ++c)
    out.append(columns[c]).append(c + 1 < columns.size() ? "," : "\n");
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (json) out += r == 0 ? "[\n  {" : ",\n  {";
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::optional<double>& value = rows[r][c];
      const bool known = value && std::isfinite(*value);
      const std::string number = known ? fmt::format("{:.12g}", *value + 0.0) : json ? "null" : "";
      if (json)
        out += fmt::format(R"({}"{}": {})", c == 0 ? "" : ", ", columns[c], number);
      else
        out.append(c == 0 ? "" : ",").append(number);
    }
    out += json ? "}" : "\n";
  }
  if (json) out += rows.empty() ? "[]\n" : "\n]\n";
  return out;
}

AnswerTable answer(const Question& question, const CollisionGround& ground, const QuestionTable& asked,
                   Progress& progress) {
  const auto& rows = asked.rows;
  AnswerTable table;
  table.columns.assign(question.columns.begin(), question.columns.end());
  table.columns.insert(table.columns.end(), question.answers.begin(), question.answers.end());
  table.rows.resize(rows.size());
  const double origin[] = {ground.origin.x, ground.origin.y, ground.origin.z};
  progress.begin(std::string_view(question.flag).substr(2), rows.size(), "questions");
  parallel_blocks(std::ssize(rows), 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t r = begin; r < end; ++r) {
      progress.advance();
      std::vector<double> local = rows[r];
      for (std::size_t axis = 0; axis < 3; ++axis) local[axis] -= origin[axis];
      Answer found;
      try {
        found = question.ask(*ground.collider, local);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::usage) throw;
        fail(ErrorKind::input, "{}:{}: {}", asked.name, asked.lines[r], error.what());
      }
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (auto& value = found[question.answer_point + axis]) *value += origin[axis];
      table.rows[r].assign(rows[r].begin(), rows[r].end());
      table.rows[r].insert(table.rows[r].end(), found.begin(), found.end());
    }
  });
  progress.end();
  return table;
}

AnswerTable walk(const CollisionGround& ground, const query::WalkSettings& settings, Console& console) {
  // How deep the capsule is in the rock of the field itself; the mesh is that far from it, at most.
  const auto depth = [&](const query::Capsule& shape) {
    if (!ground.field) return 0.0;
    const std::vector<Vec3d> points = query::surface_points(shape, 0);
    std::vector<float> values(points.size());
    ground.field->values(points, values);
    double most = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (values[i] > 0) most = std::max(most, query::depth_in(*ground.field, points[i]));
    return most;
  };
  const auto walks =
      query::random_walks(*ground.collider, ground.collider->bounds(), settings, depth, console);
  AnswerTable table;
  table.columns = {"from_x", "from_y", "from_z",  "to_x",    "to_y",       "to_z",
                   "metres", "moves",  "arrived", "overlap", "field_depth"};
  for (const query::Walk& w : walks) {
    Answer row;
    append(row, w.from + ground.origin);
    append(row, w.to + ground.origin);
    row.insert(row.end(), {w.walked.metres, w.walked.moves, w.walked.arrived, w.overlap, w.depth});
    table.rows.push_back(std::move(row));
  }
  return table;
}

void check_walks(const AnswerTable& walks) {
  std::size_t lost = 0, deep = 0;
  double worst = 0;
  for (const Answer& row : walks.rows) {
    lost += *row[arrived_column] == 0;
    deep += *row[overlap_column] > allowed_overlap;
    worst = std::max(worst, *row[overlap_column]);
  }
  if (deep)
    fail(ErrorKind::invalid, "on {} of {} routes the walker was in the rock, by up to {:.6f} m", deep,
         walks.rows.size(), worst);
  if (lost) fail(ErrorKind::invalid, "{} of {} routes were not completed", lost, walks.rows.size());
}

}  // namespace tafoni::cli
