// A terrain as a volume: a lattice of coarse values, each the height of the ground over it, is subdivided
// level by level with noise [Ju01 §2]. With `detail` the coarse values are 0 and the terrain's own shape is
// added to the subdivided noise, sample by sample.

#include "tafoni/landforms/rock/fractal_ground.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/landforms/rock/replacement.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/resample.h"

namespace tafoni::landforms::impl {
namespace {

using volume::ScalarGrid;

/// Chosen by eye.
namespace fractal_ground_look {
// Samples across the site's longer side if no spacing is given, but between a quarter of a pixel and two.
constexpr double samples_across = 400, least_pixels = 0.25, most_pixels = 2;
// The first level's cells, in shorter sides of the site; the width over which the volume takes over, in
// cells.
constexpr double coarse = 0.25, fade = 0.25;
// What values may stray from the plane beyond what all levels add, for the subdivision's rule overshoots: as
// a factor, and in cells.
constexpr double overshoot = 1.3, more_cells = 0.25;
// A pin begins at the first level whose cells are no larger than this share of its radius.
constexpr double pin_cells = 0.5;
// Step of gradients, in samples: trilinear values have gradients that jump at each cell's face, and faces
// would show in the light.
constexpr double gradient_step = 0.5;
}  // namespace fractal_ground_look

class VolumeLeaf final : public field::Function {
 public:
  VolumeLeaf(ScalarGrid grid, double amplitude)
      : grid_(std::move(grid)), most_(static_cast<float>(amplitude)) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    grid_.values(points, out);
    for (float& v : out) v = std::clamp(v, -most_, most_);
  }
  double step() const override { return fractal_ground_look::gradient_step * grid_.frame().spacing; }
  Interval range(const Box3d& box) const override {
    const Interval r = grid_.range(box);
    return {std::clamp(r.lo, -most_, most_), std::clamp(r.hi, -most_, most_)};
  }

 private:
  ScalarGrid grid_;
  float most_;
};

/// Lays out the lattice and fills it.
class LatticeFiller {
 public:
  LatticeFiller(const Ground& ground, const FractalGroundSettings& s) : ground_(ground), s_(s) {
    const raster::Raster& heights = *ground.site().heights;
    const raster::Placement& at = heights.placement;
    lo_ = {at.west, at.north - at.dy * heights.height()};
    hi_ = {at.west + at.dx * heights.width(), at.north};
    if (ground.site().region) {
      lo_ = {std::max(lo_.x, ground.box().lo.x), std::max(lo_.y, ground.box().lo.y)};
      hi_ = {std::min(hi_.x, ground.box().hi.x), std::min(hi_.y, ground.box().hi.y)};
    }
    const double wide = hi_.x - lo_.x, deep = hi_.y - lo_.y;
    const double wanted = s.spacing > 0
                              ? s.spacing
                              : std::clamp(std::max(wide, deep) / fractal_ground_look::samples_across,
                                           fractal_ground_look::least_pixels * ground.pixel(),
                                           fractal_ground_look::most_pixels * ground.pixel());
    cell_ = s.coarse > 0 ? s.coarse : fractal_ground_look::coarse * std::min(wide, deep);
    volume_.levels = std::clamp(ceil_to(std::log2(cell_ / wanted) - 1e-6), 1, 12);
    volume_.spacing = std::ldexp(cell_, -volume_.levels);
    // At level l new samples lie a half of the level's cells from old ones.
    volume_.noise =
        volume::decaying_noise(0.5 * s.noise * cell_, s.decay, volume_.levels, static_cast<int>(s.smooth));
    volume_.seed = s.seed;
    lay_out();
    fill();
    add_pins();
  }

  volume::FractalSettings settings() const { return volume_; }
  double cell() const { return cell_; }

  ScalarGrid grid(Progress& progress) const {
    const volume::Fractal fractal(volume_, progress);
    if (!s_.detail) return fractal.grid(volume::Precision::single, progress);
    // What the coarse values leave out of the terrain, column by column.
    const Vec3i n = volume_.size();
    std::vector<float> rest(std::int64_t{n.x} * n.y);
    parallel_for(n.y, [&](int j) {
      for (int i = 0; i < n.x; ++i)
        rest[std::int64_t{j} * n.x + i] = static_cast<float>(
            height(volume_.origin.x + volume_.spacing * i, volume_.origin.y + volume_.spacing * j));
    });
    ScalarGrid made({volume_.origin, volume_.spacing, n}, 0);
    const auto limit = static_cast<float>(limit_);
    const Vec3i chunks = made.chunks();
    progress.begin("subdividing", std::int64_t{chunks.x} * chunks.y * chunks.z, "chunks");
    made.generate(
        [&](const volume::SampleBox& box, float* out) { return add_detail(fractal, rest, box, limit, out); },
        progress);
    progress.end();
    return made;
  }

 private:
  static constexpr int side = ScalarGrid::chunk_samples;

  double height(double x, double y) const { return raster::sample_bicubic(*ground_.site().heights, x, y); }

  void lay_out() {
    const double most = std::accumulate(volume_.noise.begin(), volume_.noise.end(), 0.0);
    limit_ = ground_.site().amplitude;
    const auto& values = ground_.site().heights->values.values();
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double around =
        fractal_ground_look::overshoot * most + limit_ + fractal_ground_look::more_cells * cell_;
    bottom_ = *low - around;
    const double top = *high + around;
    const auto cells = [&](double extent) { return std::max(1, ceil_to(extent / cell_ - 1e-6)); };
    volume_.cells = {cells(hi_.x - lo_.x), cells(hi_.y - lo_.y), cells(top - bottom_)};
    const auto first = [&](double lo, double hi, int n) { return 0.5 * (lo + hi - n * cell_); };
    // On the global lattice of the spacing, so that neighbouring layers agree.
    const auto snap = [&](double v) { return volume_.spacing * std::floor(v / volume_.spacing); };
    volume_.origin = {snap(first(lo_.x, hi_.x, volume_.cells.x)), snap(first(lo_.y, hi_.y, volume_.cells.y)),
                      snap(first(bottom_, top, volume_.cells.z))};
  }

  void fill() {
    const Vec3i n{volume_.cells.x + 1, volume_.cells.y + 1, volume_.cells.z + 1};
    if (s_.detail) {
      volume_.coarse.assign(std::int64_t{n.x} * n.y * n.z, 0.0f);
      volume_.limit = 1e30;
      return;
    }
    volume_.limit = limit_;
    for (int k = 0; k < n.z; ++k)
      for (int j = 0; j < n.y; ++j)
        for (int i = 0; i < n.x; ++i)
          volume_.coarse.push_back(
              static_cast<float>(mean_height(volume_.origin.x + i * cell_, volume_.origin.y + j * cell_) -
                                 (volume_.origin.z + k * cell_)));
  }

  /// The mean height of a square of one cell.
  double mean_height(double x, double y) const {
    constexpr int n = 8;
    double sum = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        sum += height(x + ((i + 0.5) / n - 0.5) * cell_, y + ((j + 0.5) / n - 0.5) * cell_);
    return sum / (n * n);
  }

  void add_pins() {
    for (volume::Pin pin : s_.pins) {
      // The first level of which several samples feel it, or the last that may have pins.
      pin.level = 0;
      while (pin.level + 1 < volume_.levels &&
             std::ldexp(cell_, -pin.level) > fractal_ground_look::pin_cells * pin.radius)
        ++pin.level;
      // Over a terrain that stays, a pin says what is there in all.
      if (s_.detail) pin.value -= height(pin.position.x, pin.position.y) - pin.position.z;
      volume_.pins.push_back(pin);
    }
  }

  std::optional<float> add_detail(const volume::Fractal& fractal, const std::vector<float>& rest,
                                  const volume::SampleBox& box, float limit, float* out) const {
    const Vec3i size = box.size();
    const auto row_of = [&](int y) {
      return rest.data() + std::int64_t{box.lo.y + y} * volume_.size().x + box.lo.x;
    };
    float low = row_of(0)[0], high = low;
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) low = std::min(low, row_of(y)[x]), high = std::max(high, row_of(y)[x]);
    const Interval noise = fractal.range(box);
    const auto z_of = [&](int z) { return static_cast<float>(volume_.origin.z + volume_.spacing * z); };
    if (low - z_of(box.hi.z) + noise.lo >= limit) return limit;
    if (high - z_of(box.lo.z) + noise.hi <= -limit) return -limit;
    std::vector<float> dense(std::int64_t{size.x} * size.y * size.z);
    fractal.read(box, dense.data());
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          out[(z * side + y) * side + x] = std::clamp(
              dense[(z * size.y + y) * size.x + x] + row_of(y)[x] - z_of(box.lo.z + z), -limit, limit);
    return {};
  }

  const Ground& ground_;
  const FractalGroundSettings& s_;
  Vec2d lo_, hi_;
  double cell_ = 1, limit_ = 1, bottom_ = 0;
  volume::FractalSettings volume_;
};

}  // namespace

field::FunctionPtr volume_leaf(ScalarGrid grid, double amplitude) {
  return std::make_shared<VolumeLeaf>(std::move(grid), amplitude);
}

FractalGround fractal_ground(const Ground& ground, const FractalGroundSettings& s, Progress& progress) {
  FractalGround out;
  const Site& site = ground.site();
  if (ground.box().empty()) {
    out.result.facts.count("samples", 0).about("Samples of the volume").count("primitives", 0);
    return out;
  }
  const LatticeFiller filler(ground, s);
  const Vec3i wanted = filler.settings().size();
  constexpr double most = 0x1p32;
  if (1.0 * wanted.x * wanted.y * wanted.z > most)
    fail(ErrorKind::usage,
         "a spacing of {:.3g} m makes {} x {} x {} samples, more than 2^32; give a greater one",
         filler.settings().spacing, wanted.x, wanted.y, wanted.z);
  ScalarGrid grid = filler.grid(progress);
  const Vec3i n = grid.frame().size;
  out.result.facts.count("samples", std::int64_t{n.x} * n.y * n.z)
      .about("Samples of the volume")
      .numbers("size", {1.0 * n.x, 1.0 * n.y, 1.0 * n.z})
      .about("Samples along x, y and z")
      .length("spacing", grid.frame().spacing)
      .about("Distance between two samples")
      .length("coarse", filler.cell())
      .about("Distance between two samples of the coarsest level")
      .count("levels", filler.settings().levels)
      .about("How often the coarsest level was subdivided")
      .number("megabytes", static_cast<double>(grid.bytes()) / 1e6)
      .about("Memory of the volume in MB")
      .count("primitives", 0);
  out.result.lowest = grid.frame().box().lo.z;
  out.volume = volume_leaf(std::move(grid), site.amplitude);
  const double fade = s.fade > 0 ? s.fade : fractal_ground_look::fade * filler.cell();
  const field::FunctionPtr control = control_of(site, fade);
  // The volume has its own rock and air straight up and down as far as the region goes.
  Box3d all = Box3d::everything();
  if (site.region) {
    all = ground.box();
    all.lo.z = site.region->bounds().lo.z, all.hi.z = site.region->bounds().hi.z;
  }
  out.result.reshaped = all;
  out.result.reshape = [volume = out.volume, control,
                        t = static_cast<float>(site.amplitude)](field::NodePtr tree) {
    if (!control) return field::function(volume);
    return field::function(replace_within(field::as_function(tree, -t, t), volume, control));
  };
  return out;
}

}  // namespace tafoni::landforms::impl
