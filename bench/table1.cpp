// Table 1 of [Paris19], ours beside theirs. Builds one scene of examples/ and prints its rows.
//
//   bench_table1                         the header
//   bench_table1 NAME SCENE.toml [plain] NAME: a row of the paper; plain: the lattice by brute force, too
//
// Generation: running every layer, without reading the elevation model. Meshing: compiling and polygonizing
// with normals, what the paper calls t. The plain method asks the compiled field for every sample of the same
// lattice, one chunk after another, and polygonizes all of them: both meshes must be the same bytes.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "measure.h"
#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"
#include "tafoni/scene/products/mesh_scene.h"

namespace {

using namespace tafoni;

/// A row of the paper's table: seconds, MB, millions of evaluations.
struct PaperRow {
  const char* name;
  const char* size;
  double ratio;
  int nodes;
  double generation;
  int strokes;
  double memory, arches;
  const char* lattice;
  double t, t0;
  int calls, plain_calls;
};
constexpr std::array paper_rows{
    PaperRow{"sea", "6.0 x 6.0", 0.01, 50'693, 5.5, 156, 3.0, 300, "2000^2 x 33", 13.3, 91.5, 9, 210},
    PaperRow{"karst", "5.2 x 5.2", 0.02, 165'773, 6.2, 43, 9.9, 140, "1520^2 x 447", 14.2, 188.4, 14, 1000},
    PaperRow{"canyon", "1.1 x 1.1", 0.20, 137'043, 6.8, 0, 9.3, 110, "1000^2 x 546", 32.6, 159.0, 30, 569},
    PaperRow{"hoodoo", "0.35 x 0.35", 0.05, 55'619, 2.1, 0, 5.5, 10.2, "650^2 x 245", 2.9, 15.8, 4, 111},
    PaperRow{"benagil", "0.4 x 0.4", 0.35, 13'264, -1, 551, 1.3, 2.1, "550^2 x 87", 2.7, 3.9, 8, 20},
};

std::uint64_t hash(const void* data, std::size_t bytes, std::uint64_t h) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) h = (h ^ p[i]) * 0x100000001b3u;
  return h;
}

std::uint64_t hash_of(const mesh::Mesh& mesh) {
  std::uint64_t h = hash(mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f), 0xcbf29ce484222325u);
  h = hash(mesh.normals.data(), mesh.normals.size() * sizeof(Vec3f), h);
  return hash(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), h);
}

/// Every sample of every chunk, asked one by one.
class PlainSource final : public surface::SampleSource {
 public:
  PlainSource(const field::CompiledField& field, double voxel, Range z)
      : field_(field), voxel_(voxel), z_(z) {}
  Range column(int a, int b) override {
    a_ = a;
    b_ = b;
    return z_;
  }
  bool evaluate(int c, field::ChunkSamples& out) override {
    using S = field::ChunkSamples;
    constexpr int n = field::chunk_cells + 1;
    out.chunk = {a_, b_, c};
    out.f.resize(S::nx * S::ny * S::nz);
    std::fill(std::begin(out.active), std::end(out.active), ~std::uint64_t{0});
    points_.clear();
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          points_.push_back(Vec3d{static_cast<double>(std::int64_t{a_} * field::chunk_cells + i),
                                  static_cast<double>(std::int64_t{b_} * field::chunk_cells + j),
                                  static_cast<double>(std::int64_t{c} * field::chunk_cells + k)} *
                            voxel_);
    values_.resize(points_.size());
    field_.values(points_, values_);
    std::size_t at = 0;
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) out.f[(k * S::ny + j) * S::nx + i] = values_[at++];
    out.evaluated = points_.size();
    return true;
  }
  void gradients(std::span<const Vec3d> points, std::span<float> values, std::span<Vec3f> out) override {
    field_.gradients(points, values, out);
  }

 private:
  const field::CompiledField& field_;
  double voxel_;
  Range z_;
  int a_ = 0, b_ = 0;
  std::vector<Vec3d> points_;
  std::vector<float> values_;
};

struct Meshed {
  double seconds = 0, cpu = 0;
  surface::PolygonizeStats stats;
  std::uint64_t hash = 0;
  double bottom = 1e9, top = -1e9;  ///< metres
};

Meshed optimized(const scene::BuiltScene& scene) {
  Meshed out;
  const double start = bench::wall_seconds(), start_cpu = bench::cpu_seconds();
  const field::CompiledField field = scene.field_for(scene.boundary());
  const mesh::Mesh mesh =
      surface::polygonize(field, scene::polygonize_settings(scene, scene.voxel), silent(), &out.stats);
  out.seconds = bench::wall_seconds() - start;
  out.cpu = bench::cpu_seconds() - start_cpu;
  out.hash = hash_of(mesh);
  for (const Vec3f& p : mesh.positions) {
    out.bottom = std::min<double>(out.bottom, p.z);
    out.top = std::max<double>(out.top, p.z);
  }
  return out;
}

Meshed plain(const scene::BuiltScene& scene) {
  Meshed out;
  const double start = bench::wall_seconds(), start_cpu = bench::cpu_seconds();
  const field::CompiledField field = scene.field_for(scene.boundary());
  const auto settings = scene::polygonize_settings(scene, scene.voxel);
  const double side = scene.voxel * field::chunk_cells;
  const Box3d box = field.bounds();
  const surface::SampleSource::Range z{static_cast<int>(std::floor(box.lo.z / side)) - 1,
                                       static_cast<int>(std::floor(box.hi.z / side)) + 1};
  const surface::SourceFactory factory = [&] { return std::make_unique<PlainSource>(field, scene.voxel, z); };
  const mesh::Mesh mesh = surface::polygonize(factory, box, settings, silent(), &out.stats);
  out.seconds = bench::wall_seconds() - start;
  out.cpu = bench::cpu_seconds() - start_cpu;
  out.hash = hash_of(mesh);
  return out;
}

std::int64_t strokes(const scene::BuiltScene& scene) {
  std::int64_t total = 0;
  for (const auto& layer : scene.layers)
    if (const auto* strokes = layer.made.facts.find<std::int64_t>("strokes")) total += *strokes;
  return total;
}

/// Lattice cells of the terrain's rectangle, and from the lowest to the highest vertex.
std::string lattice(const scene::BuiltScene& scene, const Meshed& meshed) {
  const Vec3d size = scene.terrain.box.size();
  return fmt::format("{:.0f} x {:.0f} x {:.0f}", size.x / scene.voxel, size.y / scene.voxel,
                     std::ceil((meshed.top - meshed.bottom) / scene.voxel));
}

void print_paper(const PaperRow& p) {
  fmt::print("{},paper,{},{:.2f},{},{},,{},{},{},{},{},,{},{},{},,\n", p.name, p.size, p.ratio, p.nodes,
             p.generation < 0 ? std::string("-") : fmt::format("{}", p.generation), p.strokes, p.memory,
             p.arches, p.lattice, p.t, p.t0, p.calls, p.plain_calls);
}

void run(const PaperRow& row, const std::string& file, bool with_plain) {
  const scene::Document document = scene::load_scene(file);
  scene::Document bare = document;
  bare.layers.clear();
  double before = bench::cpu_seconds();
  scene::build(bare);
  const double bare_cpu = bench::cpu_seconds() - before;
  before = bench::cpu_seconds();
  const scene::BuiltScene scene = scene::build(document);
  const double generation_cpu = bench::cpu_seconds() - before - bare_cpu;
  double generation = 0;
  for (const auto& layer : scene.layers) generation += layer.seconds;
  const field::TreeStats tree = field::stats(scene.open);
  const Meshed fast = optimized(scene);
  const Meshed slow = with_plain ? plain(scene) : Meshed{};
  if (with_plain && slow.hash != fast.hash) fail(ErrorKind::internal, "{}: the plain mesh differs", row.name);
  const Vec3d size = scene.terrain.box.size();
  const auto calls = [](const surface::PolygonizeStats& s) {
    return 1e-6 * static_cast<double>(s.evaluated + s.vertices);
  };
  fmt::print(
      "{},ours,{:.2f} x {:.2f},{:.2f},{},{:.3f},{:.3f},{},{:.2f},,{},{:.3f},{:.3f},{},{:.1f},{},{},{:016x}\n",
      row.name, size.x / 1000, size.y / 1000, field::coverage(scene.open, scene.terrain.box, scene.voxel),
      tree.nodes, generation, generation_cpu, strokes(scene), 1e-6 * static_cast<double>(tree.bytes),
      lattice(scene, fast), fast.seconds, fast.cpu, with_plain ? fmt::format("{:.1f}", slow.seconds) : "",
      calls(fast.stats), with_plain ? fmt::format("{:.0f}", calls(slow.stats)) : "", fast.stats.triangles,
      fast.hash);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::puts(
        "scene,whose,size_km,a,nodes,generation_s,generation_cpu_s,strokes,tree_MB,arches_MB,lattice,mesh_s,"
        "mesh_cpu_s,plain_"
        "s,"
        "Mevaluations,plain_Mevaluations,triangles,mesh_hash");
    return 0;
  }
  for (const PaperRow& row : paper_rows) {
    if (std::strcmp(row.name, argv[1]) != 0) continue;
    try {
      print_paper(row);
      run(row, argv[2], argc > 3 && std::strcmp(argv[3], "plain") == 0);
    } catch (const Error& error) {
      std::fprintf(stderr, "%s\n", error.what());
      return 1;
    }
    return 0;
  }
  std::fprintf(stderr, "the paper's table has no row \"%s\"\n", argv[1]);
  return 2;
}
