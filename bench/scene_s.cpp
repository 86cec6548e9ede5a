// Scene S(N): 512 x 512 heights at 10 m made of eight octaves of sines, and N point primitives that carve
// tunnels of 20 points near the surface. Compiles, meshes and queries it, and prints one row of CSV.
//
//   bench_scene_s N CELLS [paper|default] [open|solid] [THREADS]
//
// CELLS counts the cells across the 5120 m. `paper` takes bilinear heights and vertical distance as document
// 003 does; `default` takes bicubic heights and first-order distance.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <sys/resource.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
#include "tafoni/mesh/polygonize.h"

namespace {

using namespace tafoni;

constexpr int pixels = 512;
constexpr double pixel = 10, extent = pixels * pixel;
constexpr double influence = 15, amplitude = 7.5;
constexpr int points_a_tunnel = 20;
constexpr double step = 8;
constexpr int queries = 1'000'000;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double elevation(double x, double y) {
  double h = 0;
  for (int k = 0; k < 8; ++k) {
    const double turn = 0.7 * k, w = 2 * std::numbers::pi * std::exp2(k) / extent;
    const double u = x * std::cos(turn) - y * std::sin(turn), v = x * std::sin(turn) + y * std::cos(turn);
    h += 250 * std::exp2(-k) * std::sin(w * u + 1.3 * k) * std::sin(w * v + 2.1 * k);
  }
  return h;
}

struct Sphere {
  Vec3d center;
  double radius, energy;
};

std::vector<Sphere> tunnels(int count) {
  std::vector<Sphere> spheres;
  spheres.reserve(static_cast<std::size_t>(count));
  Random random(7);
  while (static_cast<int>(spheres.size()) < count) {
    double x = random.uniform(40, extent - 40), y = random.uniform(40, extent - 40);
    double depth = 0, heading = random.uniform(0, 2 * std::numbers::pi);
    Vec3d p{x, y, elevation(x, y)};
    for (int i = 0; i < points_a_tunnel && static_cast<int>(spheres.size()) < count; ++i) {
      spheres.push_back({p, random.uniform(5, 6), random.uniform(-8, -7)});
      heading += random.uniform(-0.6, 0.6);
      depth = std::min(20.0, std::max(0.0, depth + random.uniform(-2, 3)));
      x = p.x + step * std::cos(heading);
      y = p.y + step * std::sin(heading);
      p += normalized(Vec3d{x, y, elevation(x, y) - depth} - p) * step;
    }
  }
  return spheres;
}

std::uint64_t hash(const void* data, std::size_t bytes, std::uint64_t h = 0xcbf29ce484222325u) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) h = (h ^ p[i]) * 0x100000001b3u;
  return h;
}

struct Timed {
  double per_second;
  std::uint64_t hash;
};

// One thread by construction: values() and gradients() run in the caller.
Timed query(const field::CompiledField& field, const std::vector<Vec3d>& points, bool gradients) {
  std::vector<float> values(points.size());
  std::vector<Vec3f> slopes(gradients ? points.size() : 0);
  double best = 1e9;
  for (int run = 0; run < 3; ++run) {
    const double t0 = seconds();
    if (gradients)
      field.gradients(points, values, slopes);
    else
      field.values(points, values);
    best = std::min(best, seconds() - t0);
  }
  std::uint64_t h = hash(values.data(), values.size() * sizeof(float));
  if (gradients) h = hash(slopes.data(), slopes.size() * sizeof(Vec3f), h);
  return {static_cast<double>(points.size()) / best, h};
}

/// The formula of DESIGN 6 by a scalar scan over every primitive, for `paper` only.
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

void run(const Options& o) {
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(pixels, pixels);
  heights->placement = {.west = 0, .north = extent, .dx = pixel, .dy = pixel};
  Box3d region{{0, 0, 1e9}, {extent, extent, -1e9}};
  for (int row = 0; row < pixels; ++row)
    for (int col = 0; col < pixels; ++col) {
      const Vec2d c = heights->placement.center(col, row);
      const float h = heights->values.at(col, row) = static_cast<float>(elevation(c.x, c.y));
      region.lo.z = std::min(region.lo.z, h - 60.0);
      region.hi.z = std::max(region.hi.z, h + 60.0);
    }
  const std::vector<Sphere> spheres = tunnels(o.count);

  const double t0 = seconds();
  field::CloudBuilder cloud(field::CloudSettings{});
  for (const Sphere& s : spheres) field::add_point(cloud, s.center, s.radius, s.energy);
  const field::TerrainSettings terrain{
      .influence = influence, .amplitude = amplitude, .bicubic = !o.paper, .first_order = !o.paper};
  field::NodePtr ground = field::heightfield(heights, terrain);
  if (o.solid) {
    const field::Domain domain{.box = {{0, 0, region.lo.z}, {extent, extent, region.hi.z}}, .inside = {}};
    ground = field::combine("intersection", {ground, field::domain(domain, terrain)});
  }
  const field::NodePtr points = cloud.finish();
  const double bytes = static_cast<double>(field::stats(points).bytes);
  const double t1 = seconds();
  const field::CompiledField field = field::compile(field::combine("blend", {ground, points}));
  const double t2 = seconds();

  mesh::PolygonizeSettings settings;
  settings.voxel = extent / o.cells;
  settings.boundary = o.solid ? mesh::Boundary::solid : mesh::Boundary::open;
  settings.region = region;
  mesh::PolygonizeStats stats;
  const mesh::Mesh mesh = mesh::polygonize(field, settings, silent(), &stats);
  const double t3 = seconds();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::uint64_t mesh_hash = hash(mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
  mesh_hash = hash(mesh.normals.data(), mesh.normals.size() * sizeof(Vec3f), mesh_hash);
  mesh_hash = hash(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), mesh_hash);

  std::vector<Vec3d> uniform, surface, near;
  Random random(11);
  for (int i = 0; i < queries; ++i) {
    const double x = random.uniform(0, extent), y = random.uniform(0, extent);
    uniform.push_back({x, y, random.uniform(region.lo.z, region.hi.z)});
    surface.push_back({x, y, elevation(x, y) + random.uniform(-20, 20)});
    const Sphere& s = spheres[static_cast<std::size_t>(random.uniform(0, o.count - 0.001))];
    near.push_back(s.center + Vec3d{random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-6, 6)});
  }
  const Timed q[] = {query(field, uniform, false), query(field, surface, false), query(field, near, false),
                     query(field, near, true)};
  std::uint64_t query_hash = 0;
  for (const Timed& t : q) query_hash = query_hash * 31 + t.hash;

  // Few samples are enough: the scan takes the same time at each.
  const int samples = std::max(20, static_cast<int>(2e7 / o.count));
  double worst = 0, sum = 0;
  const double t4 = seconds();
  for (int i = 0; i < samples; ++i) sum += brute_force(*heights, spheres, near[static_cast<std::size_t>(i)]);
  const double brute_rate = samples / (seconds() - t4);
  if (o.paper && !o.solid)
    for (int i = 0; i < samples; ++i) {
      const Vec3d p = near[static_cast<std::size_t>(i)];
      worst = std::max(worst, std::abs(brute_force(*heights, spheres, p) - field.value(p)));
    }
  if (!std::isfinite(sum) || worst > 1e-4 * amplitude)
    fail(ErrorKind::internal, "the field differs from the formula by {} m", worst);

  std::printf(
      "%d,%d,%s,%s,%d,%.4f,%.4f,%.3f,%.3f,%.2f,%.1f,%.3f,%.3f,%.3f,%llu,%.0f,%.1f,%.2f,%.2f,%.2f,%.2f,%.0f,%."
      "1e,%016llx,%016llx\n",
      o.count, o.cells, o.paper ? "paper" : "default", o.solid ? "solid" : "open", thread_count(), t1 - t0,
      t2 - t1, t3 - t2, t3 - t0, static_cast<double>(stats.evaluated) * 1e-6,
      static_cast<double>(stats.evaluated) / stats.evaluate_seconds * 1e-6, stats.evaluate_seconds,
      stats.triangles_seconds, stats.normals_seconds, static_cast<unsigned long long>(stats.triangles),
      static_cast<double>(usage.ru_maxrss) / 1024, bytes / o.count, q[0].per_second * 1e-6,
      q[1].per_second * 1e-6, q[2].per_second * 1e-6, q[3].per_second * 1e-6, brute_rate, worst,
      static_cast<unsigned long long>(mesh_hash), static_cast<unsigned long long>(query_hash));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::puts(
        "primitives,cells,terrain,boundary,threads,tree_s,compile_s,mesh_s,total_s,Msamples,Meval_s_core,"
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
    run(options);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
