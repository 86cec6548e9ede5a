// Strokes of a brush in scene S(165000) at 10 cm cells: the time from a stroke to new triangles with normals,
// beside meshing its region anew. Prints CSV.
//
//   bench_stroke [STROKES] [THREADS]
//
// A region of 40 m at each of ten random places gets a tenth of the strokes, each a carving primitive at a
// random place on the ground there; they stay. Time counts building the stroke's cloud, compiling the whole
// field and updating the mesh. Every fifth stroke the region is meshed anew and compared byte for byte.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "measure.h"
#include "scene_s.h"
#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/compiled.h"
#include "tafoni/surface/incremental_mesher.h"

namespace {

using namespace tafoni;
using namespace tafoni::bench;

constexpr double voxel = 0.1, half_region = 20, half_strokes = 14, brush = 5;
constexpr int places = 10, peer_every = 5;

struct Brush {
  const char* kind;
  double falloff;  ///< metres beyond the radius
};

struct Row {
  std::vector<double> update_ms, cpu_ms, compile_ms, anew_ms, anew_cpu_ms;
  std::uint64_t samples = 0, vertices = 0, chunks = 0, triangles = 0, mesh_hash = 0;
};

void strokes_at(Vec2d place, int strokes, const Brush& brush_kind, const field::NodePtr& scene,
                Random& random, Row& row) {
  surface::PolygonizeSettings settings;
  settings.voxel = voxel;
  settings.boundary = surface::Boundary::open;
  const double z = elevation(place.x, place.y);
  const Vec3d middle{place.x, place.y, z};
  settings.region = Box3d{middle, middle}.grown(half_region);
  surface::IncrementalMesher mesher(settings);
  field::NodePtr tree = scene;
  mesher.update(field::compile(tree), {});
  for (int i = 0; i < strokes; ++i) {
    const double x = place.x + random.uniform(-half_strokes, half_strokes),
                 y = place.y + random.uniform(-half_strokes, half_strokes);
    const Vec3d at{x, y, elevation(x, y)};

    const double c0 = bench::cpu_seconds(), t0 = seconds();
    field::CloudBuilder cloud({brush_kind.kind, brush_kind.falloff > 0 ? brush_kind.falloff : 1.0, {}});
    field::add_point(cloud, at, brush, random.uniform(-8, -7));
    const field::NodePtr stroke = cloud.finish();
    const Box3d changed = field::support(stroke);
    tree = field::blend({tree, stroke});
    const field::CompiledField field = field::compile(tree);
    const double t1 = seconds();
    mesher.update(field, {&changed, 1});
    const double t2 = seconds();
    row.cpu_ms.push_back((bench::cpu_seconds() - c0) * 1e3);
    row.compile_ms.push_back((t1 - t0) * 1e3);
    row.update_ms.push_back((t2 - t0) * 1e3);
    row.samples += mesher.stats().evaluated;
    row.vertices += mesher.stats().vertices;
    row.chunks += mesher.stats().chunks;
    if (i % peer_every != 0) continue;

    const double c3 = bench::cpu_seconds(), t3 = seconds();
    const mesh::Mesh anew = surface::polygonize(field, settings);
    row.anew_ms.push_back((seconds() - t3) * 1e3);
    row.anew_cpu_ms.push_back((bench::cpu_seconds() - c3) * 1e3);
    const std::uint64_t own = hash_of(mesher.assemble());
    if (own != hash_of(anew)) fail(ErrorKind::internal, "the updated mesh differs from one made anew");
    row.mesh_hash = row.mesh_hash * 31 + own;
    row.triangles = anew.triangles.size();
  }
}

void run(int strokes, const Brush& brush_kind) {
  const Ground ground = make_ground();
  const field::NodePtr scene = field::blend({ground_node(ground, true), cloud_of(tunnels(165000))});
  Random random(21);
  Row row;
  for (int p = 0; p < places; ++p)
    strokes_at({random.uniform(100, extent - 100), random.uniform(100, extent - 100)}, strokes / places,
               brush_kind, scene, random, row);
  const double cpu = bench::at_rank(row.cpu_ms, 0.5), anew_cpu = bench::at_rank(row.anew_cpu_ms, 0.5);
  const auto count = static_cast<double>(row.update_ms.size());
  fmt::print("{},{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.3f},", brush_kind.kind, row.update_ms.size(),
             thread_count(), bench::at_rank(row.update_ms, 0.5), bench::at_rank(row.update_ms, 0.95),
             bench::at_rank(row.update_ms, 1), cpu, bench::at_rank(row.cpu_ms, 0.95),
             bench::at_rank(row.compile_ms, 0.5));
  fmt::print("{:.1f},{:.1f},{:.1f},{:.0f},{:.0f},{:.1f},{},{:016x}\n", bench::at_rank(row.anew_ms, 0.5),
             anew_cpu, anew_cpu / cpu, static_cast<double>(row.samples) / count,
             static_cast<double>(row.vertices) / count, static_cast<double>(row.chunks) / count,
             row.triangles, row.mesh_hash);
}

}  // namespace

int main(int argc, char** argv) {
  const int strokes = argc > 1 ? std::atoi(argv[1]) : 200;
  if (argc > 2) set_thread_count(std::atoi(argv[2]));
  std::puts(
      "brush,strokes,threads,median_ms,p95_ms,worst_ms,cpu_median_ms,cpu_p95_ms,compile_ms,"
      "anew_ms,anew_cpu_ms,anew_by_update_cpu,"
      "samples_a_stroke,vertices_a_stroke,chunks_a_stroke,triangles_of_region,mesh_hash");
  try {
    run(strokes, {"point", 0});
    run(strokes, {"sphere", 2.5});
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
