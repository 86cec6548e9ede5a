#include "tafoni/volume/sample.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"

namespace tafoni::volume {
namespace {

constexpr int side = ScalarGrid::chunk_samples;
constexpr int brick = 8;

/// One chunk's samples in the making; one a thread.
class ChunkSampler {
 public:
  ChunkSampler(const field::CompiledField& field, const GridFrame& frame, float band)
      : field_(field), frame_(frame), band_(band) {}

  /// Fills out[(z * ny + y) * nx + x] of the box, at most a chunk. Gives the value where all are the same.
  std::optional<float> run(const SampleBox& box, std::vector<float>& out) {
    box_ = box;
    size_ = box.size();
    if (const auto same = constant(box)) return same;
    out.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
               static_cast<std::size_t>(size_.z));
    points_.clear(), places_.clear();
    split(box, side / 2, out);
    values_.resize(points_.size());
    field_.values(points_, values_);
    for (std::size_t i = 0; i < values_.size(); ++i)
      out[places_[i]] = band_ > 0 ? std::clamp(values_[i], -band_, band_) : values_[i];
    return {};
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

  /// Fills what is constant, down to bricks, and collects the points of the rest.
  void split(const SampleBox& box, int step, std::vector<float>& out) {
    for (int z = box.lo.z; z <= box.hi.z; z += step)
      for (int y = box.lo.y; y <= box.hi.y; y += step)
        for (int x = box.lo.x; x <= box.hi.x; x += step) {
          const SampleBox part{{x, y, z},
                               {std::min(x + step - 1, box.hi.x), std::min(y + step - 1, box.hi.y),
                                std::min(z + step - 1, box.hi.z)}};
          if (const auto same = constant(part))
            each(part, [&](Vec3i, std::size_t place) { out[place] = *same; });
          else if (step > brick)
            split(part, step / 2, out);
          else
            each(part, [&](Vec3i at, std::size_t place) {
              points_.push_back(frame_.position(at));
              places_.push_back(static_cast<std::uint32_t>(place));
            });
        }
  }

  template <class Visit>
  void each(const SampleBox& part, const Visit& visit) const {
    for (int z = part.lo.z; z <= part.hi.z; ++z)
      for (int y = part.lo.y; y <= part.hi.y; ++y)
        for (int x = part.lo.x; x <= part.hi.x; ++x)
          visit({x, y, z}, static_cast<std::size_t>(((z - box_.lo.z) * size_.y + (y - box_.lo.y)) * size_.x +
                                                    (x - box_.lo.x)));
  }

  const field::CompiledField& field_;
  const GridFrame& frame_;
  float band_;
  SampleBox box_;
  Vec3i size_;
  std::vector<Vec3d> points_;
  std::vector<float> values_;
  std::vector<std::uint32_t> places_;
};

SampleBox box_of_chunk(const ScalarGrid& grid, std::int64_t index) {
  const Vec3i n = grid.chunks(), size = grid.frame().size;
  const Vec3i lo{static_cast<int>(index % n.x) * side, static_cast<int>(index / n.x % n.y) * side,
                 static_cast<int>(index / n.x / n.y) * side};
  return {lo,
          {std::min(lo.x + side, size.x) - 1, std::min(lo.y + side, size.y) - 1,
           std::min(lo.z + side, size.z) - 1}};
}

struct Made {
  SampleBox box;
  std::optional<float> same;
  std::vector<float> values;
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
    size = static_cast<std::int32_t>(last - first) + 1;
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
  // What lies above is air, mostly.
  const Vec3d top = frame.position({frame.size.x / 2, frame.size.y / 2, frame.size.z - 1});
  float air = field.value(top);
  if (band > 0) air = std::clamp(air, -band, band);
  ScalarGrid grid(frame, air, settings.precision);
  const Vec3i n = grid.chunks();
  const std::int64_t total = std::int64_t{n.x} * n.y * n.z;
  progress.begin("sampling", static_cast<std::uint64_t>(total), "chunks");
  constexpr std::int64_t group = 256;
  std::vector<Made> made(static_cast<std::size_t>(std::min(total, group)));
  for (std::int64_t begin = 0; begin < total; begin += group) {
    const std::int64_t count = std::min(group, total - begin);
    parallel_for(
        count,
        [&](std::int64_t i) {
          Made& m = made[static_cast<std::size_t>(i)];
          m.box = box_of_chunk(grid, begin + i);
          m.same = ChunkSampler(field, frame, band).run(m.box, m.values);
        },
        progress);
    for (std::int64_t i = 0; i < count; ++i) {
      const Made& m = made[static_cast<std::size_t>(i)];
      if (m.same)
        grid.fill(m.box, *m.same);
      else
        grid.write(m.box, m.values.data());
    }
  }
  progress.end();
  return grid;
}

}  // namespace tafoni::volume
