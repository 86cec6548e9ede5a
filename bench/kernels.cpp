// The kernels that everything stands on, one thread each. See docs/benchmarks.md for what bounds them.

#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
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

/// One chunk of 64^3 cells at 1 m over a plain that points of radius 5 m cover in the given number.
void chunk(benchmark::State& state, bool bicubic) {
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(64, 64, 32.3f);
  heights->placement = {.west = -32, .north = 96, .dx = 2, .dy = 2};
  field::CloudBuilder cloud(field::CloudSettings{});
  for (Vec3d p : random_points(static_cast<std::size_t>(state.range(0)), {{0, 0, 28}, {64, 64, 36}}))
    field::add_point(cloud, p, 5, -1);
  const field::TerrainSettings settings{.bicubic = bicubic, .first_order = bicubic};
  const auto field =
      field::compile(field::combine("blend", {field::heightfield(heights, settings), cloud.finish()}));
  field::ChunkEvaluator evaluator(field, 1.0);
  field::ChunkSamples samples;
  std::int64_t evaluated = 0;
  for (auto _ : state) {
    evaluator.column(0, 0);
    evaluator.evaluate(0, samples);
    evaluated += static_cast<std::int64_t>(samples.evaluated);
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

void compile_cloud(benchmark::State& state) {
  const auto points = random_points(static_cast<std::size_t>(state.range(0)), {{0, 0, 0}, {5000, 5000, 100}});
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
