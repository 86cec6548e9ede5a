// The kernels that everything stands on, one thread each. See docs/benchmarks.md for what bounds them.

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
#include "tafoni/geology/kind.h"
#include "tafoni/math/noise.h"
#include "tafoni/terrain/analysis.h"

namespace {

using namespace tafoni;

std::vector<Vec3d> random_points(std::size_t count, const Box3d& box) {
  std::vector<Vec3d> points(count);
  Random random(3);
  for (Vec3d& p : points)
    p = {random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
         random.uniform(box.lo.z, box.hi.z)};
  return points;
}

std::shared_ptr<raster::Raster> hills(int size, double pixel) {
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(size, size);
  heights->placement = {.west = 0, .north = size * pixel, .dx = pixel, .dy = pixel};
  for (int row = 0; row < size; ++row)
    for (int col = 0; col < size; ++col) {
      const Vec2d c = heights->placement.center(col, row);
      heights->values.at(col, row) =
          100 * fbm({c.x / 500, c.y / 500, 0}, 6, 1) + 0.5f * static_cast<float>(std::sin(c.x * 0.1));
    }
  return heights;
}

void noise(benchmark::State& state) {
  const auto points = random_points(4096, {{0, 0, 0}, {100, 100, 100}});
  std::vector<float> out(points.size());
  for (auto _ : state) {
    fbm(points, static_cast<int>(state.range(0)), 1, out);
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(noise)->Name("fbm points")->ArgName("octaves")->Arg(1)->Arg(4);

/// Rock at points of a lattice, as erosion nodes and colours ask, or at scattered ones, as landforms do. The
/// label is a hash of the values, to compare machines and versions by.
void rock(benchmark::State& state, const char* kind) {
  constexpr std::int64_t n = 1 << 15;
  auto points = random_points(n, {{0, 0, 0}, {100, 100, 100}});
  if (state.range(0) == 0)
    for (std::int64_t i = 0; i < n; ++i)
      points[i] = {static_cast<double>(i % 64), static_cast<double>(i / 64 % 64),
                   static_cast<double>(i / 4096)};
  const Vec3d origin{500000, 4000000, 0};
  const auto& type = geology::find_geology(kind);
  const std::vector<geology::GeologyPtr> children(type.min_children,
                                                  geology::make_geology("strata", {}, {}, origin, 1));
  const auto node = geology::make_geology(kind, {}, children, origin, 2);
  std::vector<double> out(points.size());
  for (auto _ : state) {
    node->raws(points, out);
    benchmark::DoNotOptimize(out.data());
  }
  std::uint64_t hash = 0;
  for (double v : out) hash = hash_combine(hash, std::bit_cast<std::uint64_t>(v));
  state.SetLabel(fmt::format("{:016x}", hash));
  state.SetItemsProcessed(state.iterations() * n);
}
BENCHMARK_CAPTURE(rock, strata, "strata")->Name("rock points, strata")->ArgName("scattered")->Arg(0)->Arg(1);
BENCHMARK_CAPTURE(rock, turbulence, "turbulence")
    ->Name("rock points, turbulence")
    ->ArgName("scattered")
    ->Arg(0);
BENCHMARK_CAPTURE(rock, planes, "planes")->Name("rock points, planes")->ArgName("scattered")->Arg(0)->Arg(1);
BENCHMARK_CAPTURE(rock, fold, "fold")
    ->Name("rock points, folded strata")
    ->ArgName("scattered")
    ->Arg(0)
    ->Arg(1);
BENCHMARK_CAPTURE(rock, fault, "fault")
    ->Name("rock points, faulted strata")
    ->ArgName("scattered")
    ->Arg(0)
    ->Arg(1);

/// One chunk of 64^3 cells at 1 m over a plain that points of radius 5 m cover in the given number.
void chunk(benchmark::State& state, bool bicubic) {
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(64, 64, 32.3f);
  heights->placement = {.west = -32, .north = 96, .dx = 2, .dy = 2};
  field::CloudBuilder cloud(field::CloudSettings{});
  for (Vec3d p : random_points(state.range(0), {{0, 0, 28}, {64, 64, 36}})) field::add_point(cloud, p, 5, -1);
  const field::HeightfieldSettings settings{.bicubic = bicubic, .first_order = bicubic};
  const auto field = field::compile(field::blend({field::heightfield(heights, settings), cloud.finish()}));
  field::ChunkEvaluator evaluator(field, 1.0);
  field::ChunkSamples samples;
  std::int64_t evaluated = 0;
  for (auto _ : state) {
    evaluator.column(0, 0);
    evaluator.evaluate(0, samples);
    evaluated += samples.evaluated;
    benchmark::DoNotOptimize(samples.f.data());
  }
  state.SetItemsProcessed(evaluated);
}
BENCHMARK_CAPTURE(chunk, bilinear, false)
    ->Name("chunk samples, bilinear vertical")
    ->ArgName("points")
    ->Arg(1)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10000);
BENCHMARK_CAPTURE(chunk, bicubic, true)
    ->Name("chunk samples, bicubic first-order")
    ->ArgName("points")
    ->Arg(1)
    ->Arg(1000);

/// Beds: turbulence stretched along x and y.
class Beds final : public field::Function {
 public:
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    constexpr std::size_t batch = 128;
    Vec3d scaled[batch];
    for (std::size_t begin = 0; begin < points.size(); begin += batch) {
      const std::size_t n = std::min(batch, points.size() - begin);
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3d& p = points[begin + i];
        scaled[i] = {p.x / 200, p.y / 200, p.z / 5};
      }
      fbm({scaled, n}, 3, 1, out.subspan(begin, n));
    }
  }
  Interval range(const Box3d&) const override { return {0, 1}; }
};

/// A shape of thirty primitives, ten metres high.
field::NodePtr pillar() {
  field::CloudBuilder balls({"sphere", 2, {}});
  for (int i = 0; i < 30; ++i)
    balls.add({std::cos(i) * 0.5, std::sin(i) * 0.5, i / 3.0}, 5, std::vector<float>{0.7f});
  return balls.finish();
}

field::NodePtr hilly_chunk() {
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(64, 64);
  heights->placement = {.west = -32, .north = 96, .dx = 2, .dy = 2};
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i)
      heights->values.at(i, j) = static_cast<float>(32 + 8 * std::sin(0.1 * i) * std::cos(0.13 * j));
  return field::heightfield(heights, {});
}
field::NodePtr plain_hills() {
  return hilly_chunk();
}
field::NodePtr eroded_hills() {
  return field::erode(hilly_chunk(), nullptr, std::make_shared<Beds>(), 3);
}
field::NodePtr warped_hills() {
  return field::warp(hilly_chunk(), nullptr, {.amplitude = {3, 3, 1}});
}
/// Points far away: a control field that is 0 over the chunk.
field::NodePtr hills_beside_a_warp() {
  field::CloudBuilder cloud(field::CloudSettings{});
  field::add_point(cloud, {500, 500, 30}, 20, 1);
  return field::warp(hilly_chunk(), field::as_function(cloud.finish()), {.amplitude = {3, 3, 1}});
}
field::NodePtr pillared_hills() {
  std::vector<field::Placement> placements;
  for (Vec3d p : random_points(40, {{0, 0, 28}, {64, 64, 30}}))
    placements.push_back({p, p.x, 0, 1 + p.y / 64});
  return field::blend({hilly_chunk(), field::instances(pillar(), placements)});
}

/// The bricks of one chunk of 64^3 cells that may hold surface, and the test of all the others.
template <auto tree>
void nested(benchmark::State& state) {
  const auto field = field::compile(tree());
  field::ChunkEvaluator evaluator(field, 1.0);
  field::ChunkSamples samples;
  std::int64_t evaluated = 0;
  for (auto _ : state) {
    evaluator.column(0, 0);
    evaluator.evaluate(0, samples);
    evaluated += samples.evaluated;
    benchmark::DoNotOptimize(samples.f.data());
  }
  state.SetItemsProcessed(evaluated);
}
BENCHMARK(nested<plain_hills>)->Name("chunk samples, hills alone");
BENCHMARK(nested<eroded_hills>)->Name("chunk samples, eroded beds");
BENCHMARK(nested<warped_hills>)->Name("chunk samples, warped");
BENCHMARK(nested<hills_beside_a_warp>)->Name("chunk samples, beside a warp");
BENCHMARK(nested<pillared_hills>)->Name("chunk samples, 40 instances of 30 spheres");

void compile_cloud(benchmark::State& state) {
  const auto points = random_points(state.range(0), {{0, 0, 0}, {5000, 5000, 100}});
  for (auto _ : state) {
    field::CloudBuilder cloud(field::CloudSettings{});
    for (Vec3d p : points) field::add_point(cloud, p, 5, -7);
    benchmark::DoNotOptimize(field::compile(cloud.finish()));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(compile_cloud)->Name("points built and compiled")->Arg(200'000)->Unit(benchmark::kMillisecond);

template <auto analyse>
void analysis(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const auto heights = hills(size, 5);
  for (auto _ : state) analyse(*heights);
  state.SetItemsProcessed(state.iterations() * size * size);
}
void fill(const raster::Raster& heights) {
  benchmark::DoNotOptimize(terrain::fill_depressions(heights));
}
void drain(const raster::Raster& heights) {
  benchmark::DoNotOptimize(terrain::drainage_area(heights));
}
void access(const raster::Raster& heights) {
  benchmark::DoNotOptimize(terrain::accessibility(heights));
}
BENCHMARK(analysis<fill>)->Name("pixels, depression filling")->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(analysis<drain>)->Name("pixels, drainage area")->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(analysis<access>)->Name("pixels, accessibility")->Arg(1024)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  set_thread_count(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
