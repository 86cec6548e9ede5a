// Clicks in a scene as a game makes them: the time from a click to an edited ground with new chunk meshes and
// collision polygons, and to the first collision query at the crater, beside meshing all anew. Prints CSV.
//
//   bench_runtime SCENE [CLICKS]
//
// A click is a ray from above to a random place; every second one sets off an explosion of 2 to 3 m radius,
// the others dig or heap a sphere of such a size. They stay.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "measure.h"
#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/scene/build/build.h"

namespace {

using namespace tafoni;

double now_ms() {
  return 1e3 * bench::wall_seconds();
}

/// CPU time of all threads: what a click costs whatever else the machine does.
double cpu_ms() {
  return 1e3 * bench::cpu_seconds();
}

std::uint64_t click(runtime::DestructibleTerrain& ground, Vec3d at, int i, Random& random) {
  const double radius = random.uniform(2, 3);
  if (i % 2 == 0) return ground.explode(at, radius, 6);
  return ground.apply(volume::Tool::sphere(at, radius),
                      i % 8 == 1 ? volume::Edit::add : volume::Edit::remove);
}

void run(const scene::BuiltScene& scene, double voxel, int clicks) {
  runtime::DestructibleTerrainSettings settings;
  settings.voxel = voxel;
  const double t0 = now_ms();
  runtime::DestructibleTerrain ground(scene, settings);
  const double open_s = (now_ms() - t0) / 1000;
  const runtime::SnapshotPtr first = ground.snapshot();
  const volume::GridFrame& frame = first->grid().frame();
  const Box3d box = frame.box();

  Random random(5);
  std::vector<double> cpu, seen, queries;
  std::size_t chunks = 0;
  for (int i = 0; i < clicks; ++i) {
    const double x = random.uniform(box.lo.x + 5, box.hi.x - 5),
                 y = random.uniform(box.lo.y + 5, box.hi.y - 5);
    const auto hit = ground.snapshot()->ray(first->to_world({x, y, box.hi.z}), {0, 0, -1}, 1e4);
    if (!hit) continue;
    const double start = now_ms(), cpu_start = cpu_ms();
    const std::uint64_t version = click(ground, hit->point, i, random);
    const auto changes = ground.changes_since(version - 1);
    std::size_t bytes = 0;
    for (const auto& change : changes.chunks) bytes += ground.chunk(change.chunk).mesh->positions.size();
    seen.push_back(now_ms() - start);
    cpu.push_back(cpu_ms() - cpu_start);
    chunks += changes.chunks.size();
    (void)ground.snapshot()->sweep(query::Sphere{hit->point + Vec3d{0, 0, 4}, 0.4}, {0.3, 0.2, -8});
    queries.push_back(now_ms() - start - seen.back());
    if (bytes == 0 && !changes.chunks.empty()) fail(ErrorKind::internal, "chunks changed to nothing");
  }
  const double t1 = now_ms();
  surface::GridMesher anew({scene.boundary(), true});
  anew.update(ground.snapshot()->grid(), {});
  const double anew_ms = now_ms() - t1;
  std::uint64_t triangles = 0;
  for (const Vec3i c : anew.chunks()) triangles += anew.chunk(c)->triangles.size();

  double sum = 0;
  for (double ms : seen) sum += ms;
  const double mean = sum / static_cast<double>(seen.size());
  fmt::print("{},{}x{}x{},{:.2f},{:.0f},{},{},{:.2f},{:.2f},{:.2f},{:.2f},", voxel, frame.size.x,
             frame.size.y, frame.size.z, open_s, static_cast<double>(first->grid().bytes()) * 1e-6,
             thread_count(), seen.size(), bench::at_rank(seen, 0.5), bench::at_rank(seen, 0.95),
             bench::at_rank(seen, 1), bench::at_rank(cpu, 0.5));
  fmt::print("{:.2f},{:.2f},{:.2f},{:.0f},{:.1f},{:.0f},{:.0f},{},{:016x}\n", bench::at_rank(cpu, 0.95),
             bench::at_rank(queries, 0.5), bench::at_rank(queries, 0.95), 1000 / mean,
             static_cast<double>(chunks) / static_cast<double>(seen.size()), anew_ms,
             anew_ms / bench::at_rank(seen, 0.5), triangles, ground.state().hash);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_runtime SCENE [CLICKS]\n");
    return 2;
  }
  try {
    const scene::BuiltScene scene = scene::build(scene::load_scene(argv[1]));
    std::puts(
        "voxel,samples,open_s,grid_MB,threads,clicks,median_ms,p95_ms,worst_ms,cpu_median_ms,"
        "cpu_p95_ms,query_median_ms,query_p95_ms,clicks_a_second,chunks_a_click,anew_ms,anew_by_click,"
        "triangles,"
        "state_hash");
    for (const double voxel : {0.5, 0.25}) run(scene, voxel, argc > 2 ? std::atoi(argv[2]) : 400);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
