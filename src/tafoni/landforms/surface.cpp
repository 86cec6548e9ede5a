#include "tafoni/landforms/surface.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/spatial_hash.h"

namespace tafoni::landforms {
namespace {

using field::chunk_cells;

struct Candidate {
  Vec3d position;
  std::uint64_t priority;
};

/// One jittered candidate in every cell that the surface crosses.
void cells_of(const field::ChunkSamples& chunk, double cell, const Box3d& box, std::uint64_t seed,
              const std::function<bool(Vec3d)>& keep, std::vector<Candidate>& out) {
  for (int bz = 0; bz < field::chunk_bricks; ++bz)
    for (int by = 0; by < field::chunk_bricks; ++by)
      for (int bx = 0; bx < field::chunk_bricks; ++bx) {
        if (!chunk.brick(bx, by, bz)) continue;
        for (int n = 0; n < 512; ++n) {
          const int i = bx * 8 + (n & 7), j = by * 8 + (n >> 3 & 7), k = bz * 8 + (n >> 6);
          int solid = 0;
          for (int c = 0; c < 8; ++c) solid += chunk.at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) > 0;
          if (solid == 0 || solid == 8) continue;
          const std::int64_t x = std::int64_t{chunk.chunk.x} * chunk_cells + i,
                             y = std::int64_t{chunk.chunk.y} * chunk_cells + j,
                             z = std::int64_t{chunk.chunk.z} * chunk_cells + k;
          const Vec3d middle{(static_cast<double>(x) + 0.5) * cell, (static_cast<double>(y) + 0.5) * cell,
                             (static_cast<double>(z) + 0.5) * cell};
          if (!box.contains(middle) || !keep(middle)) continue;
          Random random(
              hash_combine(hash_combine(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)),
                           static_cast<std::uint64_t>(z)),
              seed);
          const auto jitter = [&] { return random.uniform(-0.5, 0.5) * cell; };
          const Vec3d offset{jitter(), jitter(), jitter()};
          out.push_back({middle + offset, random.next()});
        }
      }
}

/// Newton steps along the gradient; a candidate that does not arrive keeps a zero normal.
std::vector<SurfacePoint> projected(const field::CompiledField& field,
                                    const std::vector<Candidate>& candidates, double spacing) {
  const std::size_t n = candidates.size();
  std::vector<Vec3d> points(n);
  std::vector<float> f(n);
  std::vector<Vec3f> g(n);
  for (std::size_t i = 0; i < n; ++i) points[i] = candidates[i].position;
  constexpr int steps = 5;
  for (int step = 0; step < steps; ++step) {
    field.gradients(points, f, g);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d grad = to_double(g[i]);
      const double g2 = std::max(dot(grad, grad), 1e-4);
      Vec3d move = grad * (-static_cast<double>(f[i]) / g2);
      const double far = length(move);
      if (far > 0.5 * spacing) move = move * (0.5 * spacing / far);
      points[i] += move;
    }
  }
  field.gradients(points, f, g);
  std::vector<SurfacePoint> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d grad = to_double(g[i]);
    const double slope = length(grad);
    const bool arrived = slope > 1e-3 && std::fabs(f[i]) < 0.01 * spacing * slope &&
                         length(points[i] - candidates[i].position) < 1.5 * spacing;
    out[i] = {points[i], arrived ? grad * (-1 / slope) : Vec3d{}};
  }
  return out;
}

}  // namespace

std::vector<SurfacePoint> sample_surface(const field::CompiledField& field, const Box3d& box, double spacing,
                                         std::uint64_t seed, const std::function<bool(Vec3d)>& keep,
                                         Progress& progress) {
  if (!(spacing > 0)) fail(ErrorKind::usage, "the spacing of samples must be a positive length in metres");
  if (box.empty()) return {};
  const double cell = 0.75 * spacing, size = cell * chunk_cells;
  const auto index = [&](double v) { return static_cast<std::int64_t>(std::floor(v / size)); };
  const std::int64_t x0 = index(box.lo.x), x1 = index(box.hi.x), y0 = index(box.lo.y), y1 = index(box.hi.y);
  const std::int64_t columns = (x1 - x0 + 1) * (y1 - y0 + 1);
  std::vector<std::vector<Candidate>> found(static_cast<std::size_t>(columns));
  const double z0 = std::floor(box.lo.z / size), z1 = std::floor(box.hi.z / size);
  parallel_for(
      columns,
      [&](std::int64_t c) {
        field::ChunkEvaluator evaluator(field, cell);
        field::ChunkSamples chunk;
        auto range = evaluator.column(static_cast<int>(x0 + c % (x1 - x0 + 1)),
                                      static_cast<int>(y0 + c / (x1 - x0 + 1)));
        for (int k = std::max(range.first, static_cast<int>(z0));
             k <= std::min(range.last, static_cast<int>(z1)); ++k)
          if (evaluator.evaluate(k, chunk))
            cells_of(chunk, cell, box, seed, keep, found[static_cast<std::size_t>(c)]);
      },
      progress);

  std::vector<Candidate> candidates;
  for (auto& f : found) candidates.insert(candidates.end(), f.begin(), f.end());
  // Darts are thrown in an order of their own, so that no sweep shows in the pattern.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.priority, a.position.x, a.position.y, a.position.z) <
           std::tie(b.priority, b.position.x, b.position.y, b.position.z);
  });
  const std::vector<SurfacePoint> points = projected(field, candidates, spacing);
  SpatialHash taken(spacing);
  std::vector<SurfacePoint> out;
  for (const SurfacePoint& p : points) {
    if (p.normal == Vec3d{} || !box.contains(p.position) || !taken.free(p.position, spacing)) continue;
    taken.insert(p.position);
    out.push_back(p);
  }
  return out;
}

}  // namespace tafoni::landforms
