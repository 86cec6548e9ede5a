// Compiles, meshes and queries scene S(N) and prints one row of CSV.
//
//   bench_scene_s N CELLS [paper|default] [open|solid] [THREADS]
//
// CELLS counts the cells across the 5120 m. `paper` takes bilinear heights and vertical distance as
// [Paris19] does; `default` takes bicubic heights and first-order distance.

#include "scene_s.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "measure.h"
#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
#include "tafoni/surface/polygonize.h"

namespace {

using namespace tafoni;
using namespace tafoni::bench;

constexpr int queries = 1'000'000;

struct Timed {
  double per_second;
  std::uint64_t hash;
};

/// On one thread.
Timed query(const field::CompiledField& field, const std::vector<Vec3d>& points, bool gradients) {
  std::vector<float> values(points.size());
  std::vector<Vec3f> slopes(gradients ? points.size() : 0);
  double best = 1e9;
  const int threads = thread_count();
  set_thread_count(1);
  for (int run = 0; run < 3; ++run) {
    const double t0 = bench::thread_seconds();
    if (gradients)
      field.gradients(points, values, slopes);
    else
      field.values(points, values);
    best = std::min(best, bench::thread_seconds() - t0);
  }
  set_thread_count(threads);
  std::uint64_t h = hash(values.data(), values.size() * sizeof(float));
  if (gradients) h = hash(slopes.data(), slopes.size() * sizeof(Vec3f), h);
  return {static_cast<double>(points.size()) / best, h};
}

/// The formula of docs/manual.md by a scalar scan over every primitive, for `paper` only.
double brute_force(const raster::Raster& heights, const std::vector<Sphere>& spheres, Vec3d p) {
  const Vec2d at = heights.placement.pixel(p.x, p.y);
  const double u = std::clamp(at.x, 0.0, pixels - 1.0), v = std::clamp(at.y, 0.0, pixels - 1.0);
  const int i = std::min(static_cast<int>(u), pixels - 2), j = std::min(static_cast<int>(v), pixels - 2);
  const double a = u - i, b = v - j;
  const auto& h = heights.values;
  const double ground = (h.at(i, j) * (1 - a) + h.at(i + 1, j) * a) * (1 - b) +
                        (h.at(i, j + 1) * (1 - a) + h.at(i + 1, j + 1) * a) * b;
  const double d = ground - p.z, x = std::min(std::abs(d), influence);
  constexpr double T = amplitude, R = influence;
  double f = std::copysign(x + (3 * T - 2 * R) / (R * R) * x * x + (R - 2 * T) / (R * R * R) * x * x * x, d);
  for (const Sphere& s : spheres) {
    const double q = 1 - dot(p - s.center, p - s.center) / (s.radius * s.radius);
    if (q > 0) f += s.energy * q * q * q;
  }
  return f;
}

struct Options {
  int count, cells;
  bool paper = true, solid = false;
};

struct Row {
  double tree_s, compile_s, mesh_s, cpu_s, peak_mb, bytes_a_primitive;
  surface::PolygonizeStats stats;
  std::uint64_t mesh_hash, query_hash;
  Timed uniform, surface, near, gradient;
  double brute_rate, worst = 0;
};

field::NodePtr terrain_node(const Ground& ground, const Options& o) {
  const field::NodePtr node = ground_node(ground, o.paper);
  if (!o.solid) return node;
  const field::Domain domain{.box = ground.region, .inside = {}};
  return field::intersect({node, field::domain(domain, {.influence = influence, .amplitude = amplitude})});
}

void run_queries(const field::CompiledField& field, const Ground& ground, const std::vector<Sphere>& spheres,
                 const Options& o, Row& row) {
  std::vector<Vec3d> uniform, surface, near;
  Random random(11);
  for (int i = 0; i < queries; ++i) {
    const double x = random.uniform(0, extent), y = random.uniform(0, extent);
    uniform.push_back({x, y, random.uniform(ground.region.lo.z, ground.region.hi.z)});
    surface.push_back({x, y, elevation(x, y) + random.uniform(-20, 20)});
    const Sphere& s = spheres[random.below(spheres.size())];
    near.push_back(s.center + Vec3d{random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-6, 6)});
  }
  row.uniform = query(field, uniform, false);
  row.surface = query(field, surface, false);
  row.near = query(field, near, false);
  row.gradient = query(field, near, true);
  row.query_hash = 0;
  for (const Timed& t : {row.uniform, row.surface, row.near, row.gradient})
    row.query_hash = row.query_hash * 31 + t.hash;

  // Few points are enough: the scan takes the same time at each.
  near.resize(std::max(20, 20'000'000 / o.count));
  std::vector<double> truth;
  const double begin = bench::thread_seconds();
  for (Vec3d p : near) truth.push_back(brute_force(*ground.heights, spheres, p));
  row.brute_rate = static_cast<double>(near.size()) / (bench::thread_seconds() - begin);
  if (!o.paper || o.solid) return;
  for (std::size_t i = 0; i < near.size(); ++i)
    row.worst = std::max(row.worst, std::abs(truth[i] - field.value(near[i])));
  if (row.worst > 1e-4 * amplitude)
    fail(ErrorKind::internal, "the field differs from the formula by {} m", row.worst);
}

Row run(const Options& o) {
  const Ground ground = make_ground();
  const std::vector<Sphere> spheres = tunnels(o.count);
  Row row{};

  const double cpu = bench::cpu_seconds();
  const double t0 = seconds();
  const field::NodePtr points = cloud_of(spheres);
  const field::NodePtr tree = field::blend({terrain_node(ground, o), points});
  const double t1 = seconds();
  const field::CompiledField field = field::compile(tree);
  const double t2 = seconds();

  surface::PolygonizeSettings settings;
  settings.voxel = extent / o.cells;
  settings.boundary = o.solid ? surface::Boundary::solid : surface::Boundary::open;
  settings.region = ground.region;
  const mesh::Mesh mesh = surface::polygonize(field, settings, silent(), &row.stats);
  const double t3 = seconds();

  row.cpu_s = bench::cpu_seconds() - cpu;
  row.tree_s = t1 - t0;
  row.compile_s = t2 - t1;
  row.mesh_s = t3 - t2;
  row.peak_mb = bench::peak_megabytes();
  row.bytes_a_primitive = static_cast<double>(field::stats(points).bytes) / o.count;
  row.mesh_hash = hash_of(mesh);
  run_queries(field, ground, spheres, o, row);
  return row;
}

void print(const Options& o, const Row& r) {
  const auto& s = r.stats;
  const double million = 1e-6, evaluated = static_cast<double>(s.evaluated);
  fmt::print("{},{},{},{},{},{:.4f},{:.4f},{:.3f},{:.3f},{:.3f},{:.2f},{:.1f},", o.count, o.cells,
             o.paper ? "paper" : "default", o.solid ? "solid" : "open", thread_count(), r.tree_s, r.compile_s,
             r.mesh_s, r.tree_s + r.compile_s + r.mesh_s, r.cpu_s, evaluated * million,
             evaluated / s.evaluate_seconds * million);
  fmt::print("{:.3f},{:.3f},{:.3f},{},{:.0f},{:.1f},", s.evaluate_seconds, s.triangles_seconds,
             s.normals_seconds, s.triangles, r.peak_mb, r.bytes_a_primitive);
  fmt::print("{:.2f},{:.2f},{:.2f},{:.2f},{:.0f},{:.1e},{:016x},{:016x}\n", r.uniform.per_second * million,
             r.surface.per_second * million, r.near.per_second * million, r.gradient.per_second * million,
             r.brute_rate, r.worst, r.mesh_hash, r.query_hash);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::puts(
        "primitives,cells,terrain,boundary,threads,tree_s,compile_s,mesh_s,total_s,cpu_s,Msamples,Meval_s_"
        "core,"
        "evaluate_core_s,triangles_core_s,normals_core_s,triangles,peak_MB,bytes_a_primitive,"
        "Mquery_uniform_s,Mquery_surface_s,Mquery_near_s,Mgradient_near_s,brute_eval_s,"
        "worst_difference_m,mesh_hash,query_hash");
    return 0;
  }
  Options options{.count = std::atoi(argv[1]), .cells = std::atoi(argv[2])};
  for (int i = 3; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "default") options.paper = false;
    if (word == "solid") options.solid = true;
    if (const int threads = std::atoi(argv[i])) set_thread_count(threads);
  }
  try {
    print(options, run(options));
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
