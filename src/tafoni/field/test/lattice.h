#pragma once
// A hilly terrain, and the comparison of chunks with point evaluation, for tests.

#include <bit>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"

namespace tafoni::field {

inline std::shared_ptr<raster::Raster> hills(int size, double pixel, double height, std::uint64_t seed) {
  auto r = std::make_shared<raster::Raster>();
  r->values = raster::Grid<float>(size, size);
  r->placement = {-size * pixel / 2, size * pixel / 2, pixel, pixel};
  Random random(seed);
  const double a = random.uniform(0.5, 2), b = random.uniform(0.5, 2);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      r->values.at(x, y) = static_cast<float>(
          height * (std::sin(a * x * 0.31) * std::cos(b * y * 0.23) + 0.2 * std::sin(1.7 * x + 0.9 * y)));
  return r;
}

inline NodePtr terrain(double influence = 15, double amplitude = 7.5, bool bicubic = true,
                       bool first_order = true, bool prism = true) {
  const HeightfieldSettings settings{influence, amplitude, bicubic, first_order};
  const auto heights = hills(40, 5, 12, 3);
  const NodePtr land = heightfield(heights, settings);
  if (!prism) return land;
  return intersect({land, domain({{{-100, -100, -60}, {100, 100, 0}}, nullptr}, settings)});
}

/// Every lattice sample of the box of chunks, evaluated with no pruning but the engine's own summation order.
class Lattice {
 public:
  Lattice(const CompiledField& field, double voxel) : field_(field), voxel_(voxel) {}

  /// Compares each active brick's closure with point evaluation bit for bit, and each other brick's sign with
  /// brute force. Returns the number of samples compared.
  std::size_t check(int x0, int x1, int y0, int y1) {
    ChunkEvaluator evaluator(field_, voxel_);
    ChunkSamples chunk;
    std::size_t compared = 0;
    for (int b = y0; b <= y1; ++b)
      for (int a = x0; a <= x1; ++a) {
        const auto range = evaluator.column(a, b);
        for (int c = range.first - 1; c <= range.last + 1; ++c) {
          const bool any = evaluator.evaluate(c, chunk);
          compared += check_chunk(chunk, a, b, c, any, c >= range.first && c <= range.last);
        }
      }
    return compared;
  }

 private:
  std::size_t check_chunk(const ChunkSamples& chunk, int a, int b, int c, bool any, bool inside) {
    constexpr int n = chunk_cells + 1;
    std::vector<Vec3d> points;
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          points.push_back({(a * 64 + i) * voxel_, (b * 64 + j) * voxel_, (c * 64 + k) * voxel_});
    std::vector<float> f(points.size());
    field_.values(points, f);
    const auto value = [&](int i, int j, int k) { return f[(k * n + j) * n + i]; };
    std::size_t compared = 0, wrong = 0, missed = 0;
    for (int bz = 0; bz < 8; ++bz)
      for (int by = 0; by < 8; ++by)
        for (int bx = 0; bx < 8; ++bx) {
          const bool active = any && chunk.brick(bx, by, bz);
          const bool positive = value(bx * 8, by * 8, bz * 8) > 0;
          for (int k = bz * 8; k <= bz * 8 + 8; ++k)
            for (int j = by * 8; j <= by * 8 + 8; ++j)
              for (int i = bx * 8; i <= bx * 8 + 8; ++i) {
                const float v = value(i, j, k);
                if (active) {
                  ++compared;
                  wrong += std::bit_cast<std::uint32_t>(chunk.at(i, j, k)) != std::bit_cast<std::uint32_t>(v);
                } else {
                  missed += (v > 0) != positive;
                }
              }
        }
    EXPECT_EQ(wrong, 0u) << "of " << compared << " in chunk " << a << " " << b << " " << c;
    EXPECT_EQ(missed, 0u) << "sign changes in inactive bricks of chunk " << a << " " << b << " " << c;
    EXPECT_TRUE(inside || !any) << "surface outside column()'s range";
    return compared;
  }

  const CompiledField& field_;
  double voxel_;
};

}  // namespace tafoni::field
