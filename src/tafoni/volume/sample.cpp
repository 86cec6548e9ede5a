// A field as a grid: columns of blocks go to threads, whose evaluators look only at bricks that may hold
// the surface. What an interval shows to be one value, or beyond the band, is written down without
// looking.

#include "tafoni/volume/sample.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/chunks.h"
#include "tafoni/math/lattice.h"
#include "tafoni/math/whole.h"

namespace tafoni::volume {
namespace {

constexpr int columns_at_once = 16;
constexpr int grid_side = ScalarGrid::chunk_samples, block_side = field::chunk_cells,
              brick = field::brick_cells;
static_assert(block_side % grid_side == 0 && grid_side % brick == 0);

/// A chunk of the grid: all samples alike, or one by one, x fastest.
struct Made {
  SampleBox box;
  std::optional<float> same;
  std::vector<float> values;
};

SampleBox common(const SampleBox& a, Vec3i lo, int size) {
  return {lo,
          {std::min(lo.x + size - 1, a.hi.x), std::min(lo.y + size - 1, a.hi.y),
           std::min(lo.z + size - 1, a.hi.z)}};
}

/// Samples a column of blocks of 64^3 samples. One a thread.
class ColumnSampler {
 public:
  ColumnSampler(const field::CompiledField& field, const GridFrame& frame, float band, bool limit,
                const Progress& progress)
      : field_(field),
        frame_(frame),
        band_(band),
        limit_(limit && band > 0),
        evaluator_(field, frame.spacing, frame.origin,
                   band > 0 ? band : std::numeric_limits<float>::infinity()) {
    evaluator_.watch(progress);
  }

  /// The chunks of column (a, b) of blocks, from the lowest up.
  void run(int a, int b, std::vector<Made>& out) {
    out.clear();
    const SampleBox all{{0, 0, 0}, {frame_.size.x - 1, frame_.size.y - 1, frame_.size.z - 1}};
    bool prepared = false;
    for (int c = 0; c * block_side < frame_.size.z; ++c) {
      const SampleBox block = common(all, {a * block_side, b * block_side, c * block_side}, block_side);
      const auto same = constant(block);
      if (!same) {
        if (!prepared) evaluator_.column(a, b);
        prepared = true;
        evaluate(block, c);
      }
      for (int z = block.lo.z; z <= block.hi.z; z += grid_side)
        for (int y = block.lo.y; y <= block.hi.y; y += grid_side)
          for (int x = block.lo.x; x <= block.hi.x; x += grid_side) {
            Made& made = out.emplace_back();
            made.box = common(block, {x, y, z}, grid_side);
            made.same = same ? same : constant(made.box);
            if (!made.same) gather(block.lo, made);
          }
    }
  }

 private:
  /// What every sample of the box is, where its interval tells. Zero has two signs, so it is evaluated.
  std::optional<float> constant(const SampleBox& box) const {
    const Interval range = field_.interval({frame_.position(box.lo), frame_.position(box.hi)});
    if (band_ > 0 && range.lo >= band_) return band_;
    if (band_ > 0 && range.hi <= -band_) return -band_;
    if (range.lo == range.hi && range.lo != 0) return range.lo;
    return {};
  }

  void evaluate(const SampleBox& block, int c) {
    const Vec3i n = block.size();
    std::fill(std::begin(samples_.active), std::end(samples_.active), 0);
    evaluator_.evaluate(c, {{0, 0, 0}, {(n.x - 1) / brick, (n.y - 1) / brick, (n.z - 1) / brick}}, samples_);
  }

  /// Copies a chunk's samples out of the block that begins at `first`.
  void gather(Vec3i first, Made& made) const {
    const SampleBox& box = made.box;
    made.values.resize(box.count());
    for (int z = box.lo.z; z <= box.hi.z; z += brick)
      for (int y = box.lo.y; y <= box.hi.y; y += brick)
        for (int x = box.lo.x; x <= box.hi.x; x += brick) gather_brick(first, {x, y, z}, made);
    const std::vector<float>& v = made.values;
    if (std::memcmp(v.data(), v.data() + 1, (v.size() - 1) * sizeof(float)) == 0) made.same = v.front();
  }

  void gather_brick(Vec3i first, Vec3i lo, Made& made) const {
    const Vec3i at = lo - first;
    const SampleBox part = common(made.box, lo, brick);
    const bool active = samples_.brick(at.x / brick, at.y / brick, at.z / brick);
    // All samples lie beyond the band, where one of them tells on which side all are.
    const float beyond = active ? 0 : std::copysign(band_, field_.value(frame_.position(lo)));
    for (int k = 0; k < part.size().z; ++k)
      for (int j = 0; j < part.size().y; ++j) {
        float* row = made.values.data() + made.box.index(lo + Vec3i{0, j, k});
        for (int i = 0; i < part.size().x; ++i) {
          const float v = active ? samples_.at(at.x + i, at.y + j, at.z + k) : beyond;
          row[i] = limit_ ? std::clamp(v, -band_, band_) : v;
        }
      }
  }

  const field::CompiledField& field_;
  const GridFrame& frame_;
  float band_;
  bool limit_;
  field::ChunkEvaluator evaluator_;
  field::ChunkSamples samples_;
};

}  // namespace

GridFrame frame_over(const Box3d& box, double spacing) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    fail(ErrorKind::usage, "a volume's spacing must be a positive length in metres, not {:g}", spacing);
  if (box.empty() || !box.bounded())
    fail(ErrorKind::usage, "what a volume is sampled over must be a bounded box; give one");
  GridFrame frame;
  frame.spacing = spacing;
  const auto axis = [&](double lo, double hi, double& origin, std::int32_t& size) {
    constexpr double most = 1 << 30;
    const double first = std::floor(lo / spacing);
    const double last = std::max(std::ceil(hi / spacing), first + 1);
    if (!(last - first < most))
      fail(ErrorKind::usage, "{:g} m is too fine a spacing for a volume of {:g} m", spacing, hi - lo);
    origin = first * spacing;
    size = floor_to(last - first) + 1;
  };
  axis(box.lo.x, box.hi.x, frame.origin.x, frame.size.x);
  axis(box.lo.y, box.hi.y, frame.origin.y, frame.size.y);
  axis(box.lo.z, box.hi.z, frame.origin.z, frame.size.z);
  return frame;
}

ScalarGrid sample(const field::CompiledField& field, const GridFrame& frame, const SampleSettings& settings,
                  Progress& progress) {
  const auto band = static_cast<float>(settings.band);
  if (!(band >= 0) || !std::isfinite(band))
    fail(ErrorKind::usage, "a volume's band must be a length in metres, 0 for none, not {:g}", settings.band);
  // What lies above is mostly air.
  const Vec3d top = frame.position({frame.size.x / 2, frame.size.y / 2, frame.size.z - 1});
  float air = field.value(top);
  if (band > 0) air = std::clamp(air, -band, band);
  ScalarGrid grid(frame, air, settings.precision);
  const int columns_x = (frame.size.x + block_side - 1) / block_side,
            columns_y = (frame.size.y + block_side - 1) / block_side;
  const std::int64_t total = std::int64_t{columns_x} * columns_y;
  progress.begin("sampling", total, "columns");
  struct Column {
    std::unique_ptr<ColumnSampler> sampler;
    std::vector<Made> chunks;
  };
  std::vector<Column> group(std::min<std::int64_t>(total, columns_at_once));
  for (std::int64_t begin = 0; begin < total; begin += columns_at_once) {
    const std::int64_t count = std::min<std::int64_t>(columns_at_once, total - begin);
    parallel_for(
        count,
        [&](std::int64_t i) {
          Column& column = group[i];
          if (!column.sampler)
            column.sampler = std::make_unique<ColumnSampler>(field, frame, band, settings.limit, progress);
          const Vec3i at = sample_at({columns_x, columns_y, 1}, begin + i);
          column.sampler->run(at.x, at.y, column.chunks);
        },
        progress);
    for (std::int64_t i = 0; i < count; ++i)
      for (const Made& made : group[i].chunks) {
        if (made.same)
          grid.fill(made.box, *made.same);
        else
          grid.write(made.box, made.values.data());
      }
  }
  progress.end();
  return grid;
}

}  // namespace tafoni::volume
