// Fractal volumes and tunnels [Ju01] beside plain programs for the same work, in one process, the
// runs interleaved since machines drift. Prints CSV.
//
//   bench_fractal [RUNS]
//
// The plain subdivision makes level after level, sample by sample, with the same rule and the same noise; its
// hash must be ours. The plain tunnel asks every segment at every sample of the tunnel's box.

#include "tafoni/volume/fractal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <vector>

#include "measure.h"

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/volume/tunnel.h"

namespace {

using namespace tafoni;
using namespace tafoni::volume;

/// The best of several runs.
struct Best {
  double wall = 1e9, cpu = 1e9;

  template <class F>
  void time(const F& run, double share = 1) {
    const double start = bench::wall_seconds(), cpu_start = bench::cpu_seconds();
    run();
    wall = std::min(wall, (bench::wall_seconds() - start) / share);
    cpu = std::min(cpu, (bench::cpu_seconds() - cpu_start) / share);
  }
  void print(const char* work, const char* program, int threads, double samples) const {
    std::printf("%s,%s,%d,%.4f,%.4f,%.0f\n", work, program, threads, wall, cpu, samples / cpu / 1e6);
  }
};

constexpr int nx = 512, ny = 512, nz = 256;

FractalSettings cube() {
  FractalSettings s;
  s.cells = {2, 2, 1};
  s.levels = 8;
  for (int z = 0; z < 2; ++z) s.coarse.insert(s.coarse.end(), 9, z ? -1.0f : 1.0f);
  s.noise = decaying_noise(0.6, 0.5, s.levels, 0);
  s.seed = 7;
  return s;
}

/// By sample; the noise as impl/subdivision.cpp has it.
struct Plain {
  Vec3i size{};
  std::vector<float> values{};

  std::ptrdiff_t at(int x, int y, int z) const { return (std::ptrdiff_t{z} * size.y + y) * size.x + x; }

  /// One axis twice as fine.
  Plain finer(int axis) const {
    const int n[3] = {size.x, size.y, size.z};
    Plain out{size, {}};
    (axis == 0 ? out.size.x : axis == 1 ? out.size.y : out.size.z) = 2 * n[axis] - 1;
    out.values.resize(static_cast<std::size_t>(out.size.x) * out.size.y * out.size.z);
    const std::ptrdiff_t step = axis == 0 ? 1 : axis == 1 ? size.x : std::ptrdiff_t{size.x} * size.y;
    std::size_t o = 0;
    for (int z = 0; z < out.size.z; ++z)
      for (int y = 0; y < out.size.y; ++y)
        for (int x = 0; x < out.size.x; ++x, ++o) {
          int p[3] = {x, y, z};
          const int i = p[axis] / 2;
          const bool kept = p[axis] % 2 == 0;
          p[axis] = i;
          const float* b = values.data() + at(p[0], p[1], p[2]);
          if (kept) {
            out.values[o] = *b;
            continue;
          }
          const float c = b[step], a = i > 0 ? b[-step] : 2 * b[0] - c,
                      d = i + 2 < n[axis] ? b[2 * step] : 2 * c - b[0];
          out.values[o] = (9 * (*b + c) - (a + d)) * 0.0625f;
        }
    return out;
  }

  void add_noise(std::uint64_t key, float amplitude) {
    if (!(amplitude > 0)) return;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y) {
        const std::uint64_t row =
            mix64(key ^ mix64((static_cast<std::uint64_t>(z) << 32) | static_cast<std::uint64_t>(y)));
        for (int x = ((y | z) & 1) ? 0 : 1; x < size.x; x += ((y | z) & 1) ? 1 : 2) {
          std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b1u + static_cast<std::uint32_t>(row);
          h = (h ^ (h >> 16)) * 0x7feb352du;
          h = (h ^ (h >> 15) ^ static_cast<std::uint32_t>(row >> 32)) * 0x846ca68bu;
          h ^= h >> 16;
          values[at(x, y, z)] += static_cast<float>(static_cast<std::int32_t>(h)) * (amplitude * 0x1p-31f);
        }
      }
  }
};

Plain plain_fractal(const FractalSettings& s) {
  Plain p{{s.cells.x + 1, s.cells.y + 1, s.cells.z + 1}, s.coarse};
  for (int level = 0; level < s.levels; ++level) {
    p = p.finer(2).finer(1).finer(0);
    p.add_noise(hash_combine(s.seed, level), static_cast<float>(s.noise[level]));
  }
  return p;
}

void terrain(int runs) {
  const FractalSettings s = cube();
  Best ours, plain;
  double worst = 0;
  std::uint64_t hash = 0;
  for (int run = 0; run < runs; ++run) {
    std::optional<ScalarGrid> grid;
    ours.time([&] { grid = Fractal(s).grid({{0, 0, 0}, {nx - 1, ny - 1, nz - 1}}); });
    if (run > 1) continue;  // the plain one takes long
    Plain p;
    plain.time([&] { p = plain_fractal(s); });
    for (int z = 0; z < nz; z += 3)
      for (int y = 0; y < ny; y += 5)
        for (int x = 0; x < nx; x += 7) {
          const float v = grid->at({x, y, z});
          worst = std::max<double>(worst, std::abs(v - p.values[p.at(x, y, z)]));
          hash = hash_combine(hash, std::bit_cast<std::uint32_t>(v));
        }
  }
  constexpr double samples = static_cast<double>(nx) * ny * nz;
  ours.print("fractal 512x512x256", "tafoni", thread_count(), samples);
  plain.print("fractal 512x512x256", "plain", 1, samples);
  std::printf("# fractal: hash %016llx, differs by %.1e at most\n", static_cast<unsigned long long>(hash),
              worst);
}

/// 200 m of 3 m radius at 25 cm, in rock that is 1 m deep everywhere.
void tunnel(int runs) {
  const Tunnel axis = fractal_tunnel({20, 60, 30}, {178.5, 64, 34}, {});
  const GridFrame frame{{0, 0, 0}, 0.25, {800, 512, 256}};
  constexpr int planes = 16;
  Best ours, plain;
  double worst = 0, samples = 0;
  for (int run = 0; run < runs; ++run) {
    ScalarGrid grid(frame, 1);
    ours.time([&] { carve(grid, {&axis, 1}, 1); });
    if (run > 0) continue;
    ScalarGrid slow(frame, 1);
    plain.time(
        [&] {
          SampleBox box = slow.samples_in(bounds(axis, 1));
          for (int z = box.lo.z / planes * planes; z <= box.hi.z; z += planes)
            slow.edit({{box.lo.x, box.lo.y, z}, {box.hi.x, box.hi.y, z}},
                      [&](Vec3i first, std::span<float> row) {
                        for (std::size_t i = 0; i < row.size(); ++i) {
                          const Vec3d p = frame.position(first + Vec3i{static_cast<int>(i), 0, 0});
                          row[i] = std::min(row[i], static_cast<float>(distance(axis, p)));
                        }
                      });
        },
        1.0 / planes);
    for (int z = 0; z < frame.size.z; ++z)
      for (int y = 0; y < frame.size.y; ++y)
        for (int x = 0; x < frame.size.x; ++x) {
          const float v = grid.at({x, y, z});
          samples += v < 1;
          if (z % planes == 0) worst = std::max<double>(worst, std::abs(v - slow.at({x, y, z})));
        }
  }
  ours.print("tunnel", "tafoni", thread_count(), samples);
  plain.print("tunnel", "plain", 1, samples);
  std::printf("# tunnel: %.0f m, %.0f samples, differs by %.1e m at most\n", length(axis), samples, worst);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  std::printf("work,program,threads,seconds (best),processor seconds,million samples a processor second\n");
  terrain(runs);
  tunnel(runs);
}
