// Below the terrain's base the field is sampled where intervals leave room for a surface, a column of chunks
// at a time, from the bottom up: the first sample with another sign beside it is the column's lowest place.
#include "tafoni/scene/build/impl/base.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/core.h>

#include "tafoni/core/parallel.h"
#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/resample.h"

namespace tafoni::scene::impl {
namespace {

namespace base_search {
// Cells along the longer side at most: a lattice that is much finer than what landforms carve takes longer to
// search, and finds no more.
constexpr double most_cells = 4096;
}  // namespace base_search

constexpr double nowhere = std::numeric_limits<double>::infinity();

/// The lattice that is searched, between two levels of it.
class Depths {
 public:
  Depths(const terrain::Terrain& terrain, const field::CompiledField& field, double step, int first, int last)
      : terrain_(terrain), field_(field), step_(step), first_(first), last_(last) {}

  /// Local z of the surface's lowest sample below the last level.
  double lowest(Progress& progress) const {
    const int south = chunk(terrain_.box.lo.y), rows = chunk(terrain_.box.hi.y) - south + 1;
    const int west = chunk(terrain_.box.lo.x), east = chunk(terrain_.box.hi.x);
    std::vector<int> found(rows, last_);
    progress.begin("looking below the base", rows, "rows");
    parallel_for(
        rows,
        [&](std::int64_t row) {
          field::ChunkEvaluator evaluator(field_, step_);
          field::ChunkSamples samples;
          int& own = found[row];
          for (int a = west; a <= east; ++a) {
            own = std::min(own, in_column(a, south + static_cast<int>(row), own, evaluator, samples));
            progress.check();
          }
        },
        progress);
    progress.end();
    const int level = *std::min_element(found.begin(), found.end());
    return level < last_ ? level * step_ : nowhere;
  }

 private:
  int chunk(double v) const { return floor_to(v / (step_ * field::chunk_cells)); }

  /// The lowest level of the surface in the column, or `limit` where there is none below it.
  int in_column(int a, int b, int limit, field::ChunkEvaluator& evaluator,
                field::ChunkSamples& samples) const {
    constexpr int n = field::chunk_cells;
    const auto range = evaluator.column(a, b);
    const auto chunk_of = [](int level) { return level >= 0 ? level / n : (level + 1) / n - 1; };
    for (int c = std::max(range.first, chunk_of(first_)); c <= std::min(range.last, chunk_of(limit - 1));
         ++c) {
      field::BrickBox bricks;
      bricks.hi.z = std::min(n - 1, limit - 1 - c * n) / field::brick_cells;
      if (!evaluator.evaluate(c, bricks, samples)) continue;
      const int level = in_chunk({a, b, c}, bricks.hi.z, limit, samples);
      if (level < limit) return level;
    }
    return limit;
  }

  int in_chunk(Vec3i chunk, int top, int limit, const field::ChunkSamples& samples) const {
    for (int bz = 0; bz <= top; ++bz)
      for (int k = bz * field::brick_cells; k < (bz + 1) * field::brick_cells; ++k) {
        const int level = chunk.z * field::chunk_cells + k;
        if (level >= limit) return limit;
        if (level < first_) continue;
        for (int by = 0; by < field::chunk_bricks; ++by)
          for (int bx = 0; bx < field::chunk_bricks; ++bx)
            if (samples.brick(bx, by, bz) && crosses({chunk.x, chunk.y, 0}, bx, by, k, samples)) return level;
      }
    return limit;
  }

  /// Whether the surface crosses level k of the brick, within the domain, there or on the way up to the next.
  bool crosses(Vec3i chunk, int bx, int by, int k, const field::ChunkSamples& samples) const {
    constexpr int n = field::brick_cells;
    bool rock = false, air = false;
    for (int j = by * n; j <= (by + 1) * n; ++j)
      for (int i = bx * n; i <= (bx + 1) * n; ++i) {
        if (!inside((chunk.x * field::chunk_cells + i) * step_, (chunk.y * field::chunk_cells + j) * step_))
          continue;
        for (const int level : {k, k + 1}) (samples.at(i, j, level) > 0 ? rock : air) = true;
        if (rock && air) return true;
      }
    return false;
  }

  bool inside(double x, double y) const {
    const Box3d& box = terrain_.box;
    return x >= box.lo.x && x <= box.hi.x && y >= box.lo.y && y <= box.hi.y &&
           (!terrain_.inside || raster::sample_bilinear(*terrain_.inside, x, y) > 0);
  }

  const terrain::Terrain& terrain_;
  const field::CompiledField& field_;
  double step_;
  int first_, last_;
};

}  // namespace

double base_of(const BaseSearch& search, Progress& progress) {
  const Box3d& box = search.terrain.box;
  // Where nothing is known of how deep a layer reaches, it goes up and down like the terrain.
  if (!(search.lowest < box.lo.z) || !std::isfinite(search.lowest)) return box.lo.z;
  const field::CompiledField field = field::compile(search.open);
  const double deepest = std::max(search.lowest, field.bounds().lo.z), limit = box.lo.z - deepest_base;
  if (!(deepest < box.lo.z)) return box.lo.z;
  double step = search.voxel;
  while (std::max(box.size().x, box.size().y) / step > base_search::most_cells) step *= 2;
  const auto lowest_above = [&](double z) {
    return Depths(search.terrain, field, step, floor_to(z / step) - 1, floor_to(box.lo.z / step))
        .lowest(progress);
  };
  double lowest = lowest_above(deepest);
  if (lowest < limit) {
    progress.warn(fmt::format(
        "what is carved or built more than {:g} m below the terrain is cut off at an elevation of {:.6g} m; "
        "check its positions",
        deepest_base, limit + search.terrain.origin.z));
    lowest = lowest_above(limit);
  }
  if (lowest == nowhere) return box.lo.z;
  return std::floor((lowest - search.influence) / search.voxel) * search.voxel;
}

}  // namespace tafoni::scene::impl
