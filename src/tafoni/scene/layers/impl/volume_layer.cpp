#include "tafoni/scene/layers/impl/volume_layer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tafoni/core/parallel.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::scene::impl {
namespace {

using volume::ScalarGrid;

/// Beyond any field's value.
constexpr float far_away = 1e4f;

/// Maps [-band, band] to [-T, T]: as it is near 0, so that the surface stays where it is, then stretched.
/// Else rock within a narrow band would be no deeper than the band, and later layers would carve into what is
/// solid. Leaves values as they are where the band is no narrower than T.
class Stretch {
 public:
  Stretch(float band, float amplitude)
      : narrow_(band < amplitude),
        band_(band),
        knee_(0.75f * band),
        slope_(band > 0 ? (amplitude - knee_) / (band - knee_) : 0),
        amplitude_(amplitude) {}

  float operator()(float v) const {
    const float a = std::abs(v);
    if (!narrow_ || a <= knee_) return v;
    return std::copysign(a < band_ ? std::min(knee_ + (a - knee_) * slope_, amplitude_) : amplitude_, v);
  }
  float slope(float v) const {
    const float a = std::abs(v);
    return !narrow_ || a <= knee_ ? 1 : a < band_ ? slope_ : 0;
  }

 private:
  bool narrow_;
  float band_, knee_, slope_, amplitude_;
};

/// A grid at its place. Beyond the frame its border goes on, or it is `outside`.
class Placed final : public field::Function {
 public:
  Placed(const ScalarGrid& grid, Vec3d shift, Stretch stretch, std::optional<float> outside)
      : grid_(grid),
        box_{grid.frame().box().lo + shift, grid.frame().box().hi + shift},
        shift_(shift),
        stretch_(stretch),
        outside_(outside) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = beyond(points[i]) ? *outside_ : stretch_(grid_.value(points[i] - shift_));
  }
  void gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d p = points[i] - shift_;
      out[i] = {};
      if (beyond(points[i])) continue;
      grid_.gradients({&p, 1}, out.subspan(i, 1));
      out[i] = out[i] * stretch_.slope(grid_.value(p));
    }
  }
  Interval range(const Box3d& box) const override {
    if (outside_ && !box.overlaps(box_)) return {*outside_, *outside_};
    const Interval r = grid_.range({box.lo - shift_, box.hi - shift_});
    Interval out{stretch_(r.lo), stretch_(r.hi)};
    if (outside_ && !(box_.contains(box.lo) && box_.contains(box.hi)))
      out = {std::min(out.lo, *outside_), std::max(out.hi, *outside_)};
    return out;
  }
  const Box3d& box() const { return box_; }

 private:
  bool beyond(Vec3d p) const { return outside_ && !box_.contains(p); }

  ScalarGrid grid_;
  Box3d box_;
  Vec3d shift_;
  Stretch stretch_;
  std::optional<float> outside_;
};

/// Elevations of the highest surface along columns of samples, from the top down.
class Tops {
 public:
  explicit Tops(const ScalarGrid& grid) : grid_(grid), frame_(grid.frame()) {}

  /// For the columns of samples of chunk column (a, b), out[y * nx + x]: local z, the floor where there is
  /// none.
  void find(int a, int b, std::vector<double>& out) {
    constexpr int side = ScalarGrid::chunk_samples;
    const Vec3i n = frame_.size;
    volume::SampleBox box{{a * side, b * side, 0},
                          {std::min(a * side + side, n.x) - 1, std::min(b * side + side, n.y) - 1, 0}};
    const auto columns = static_cast<std::size_t>(box.size().x) * static_cast<std::size_t>(box.size().y);
    out.assign(columns, frame_.origin.z);
    above_.assign(columns, -1);
    found_.assign(columns, 0);
    std::size_t left = columns;
    for (int c = grid_.chunks().z - 1; c >= 0 && left > 0; --c) {
      float same = 0;
      if (grid_.uniform({a, b, c}, &same) && same <= 0) {
        above_.assign(columns, same);
        continue;
      }
      box.lo.z = c * side, box.hi.z = std::min(c * side + side, n.z) - 1;
      samples_.resize(columns * static_cast<std::size_t>(box.size().z));
      grid_.read(box, samples_.data());
      for (int z = box.hi.z; z >= box.lo.z && left > 0; --z)
        left -= level(z, samples_.data() + columns * static_cast<std::size_t>(z - box.lo.z), out);
    }
  }

 private:
  /// Columns whose first rock is at this level. Returns how many.
  std::size_t level(int z, const float* samples, std::vector<double>& out) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float v = samples[i];
      if (!found_[i] && v > 0) {
        const double t = z == frame_.size.z - 1 ? 0 : static_cast<double>(v) / (v - above_[i]);
        out[i] = frame_.origin.z + frame_.spacing * (z + t);
        found_[i] = 1;
        ++found;
      }
      above_[i] = v;
    }
    return found;
  }

  const ScalarGrid& grid_;
  volume::GridFrame frame_;
  std::vector<float> samples_, above_;
  std::vector<std::uint8_t> found_;
};

}  // namespace

const std::vector<ParamInfo>& volume_params() {
  using S = VolumeSettings;
  static const std::vector<ParamInfo> params =
      ParamTable<S>()
          .text("file", &S::file, "Path of a volume: .tvol or .vdb")
          .choice("mode", &S::mode, {"replace", "insert", "union", "intersection", "carve"},
                  "replace leaves nothing of the layers below, insert does so within the volume's box, union "
                  "adds "
                  "its rock, intersection keeps what is rock in both, carve removes its rock")
          .numbers(
              "at", &S::at, "m", 3, -1e9, 1e9,
              "Where the middle of its box is put, x, y, z in the scene's CRS; none leaves it where the file "
              "says");
  return params;
}

landforms::Result place_volume(const io::Volume& volume, const VolumeSettings& settings, Vec3d origin,
                               double amplitude) {
  const volume::GridFrame& frame = volume.grid.frame();
  const Vec3d shift =
      (settings.at.empty() ? volume.origin
                           : Vec3d{settings.at[0], settings.at[1], settings.at[2]} - frame.box().center()) -
      origin;
  const Interval range = volume.grid.range(frame.box());
  const Stretch stretch(std::max(std::abs(range.lo), std::abs(range.hi)), static_cast<float>(amplitude));
  const auto leaf = [&](std::optional<float> outside) {
    return field::function(std::make_shared<Placed>(volume.grid, shift, stretch, outside));
  };
  landforms::Result out;
  out.reshaped = Box3d{frame.box().lo + shift, frame.box().hi + shift};
  if (settings.mode == "replace") {
    out.reshape = [own = leaf({})](const field::NodePtr&) { return own; };
    out.reshaped = Box3d::everything();
  } else if (settings.mode == "intersection") {
    out.reshape = [own = leaf({})](field::NodePtr below) {
      return field::intersect({std::move(below), own});
    };
    out.reshaped = Box3d::everything();
  } else if (settings.mode == "insert") {
    // max(f, v) is at least v, and the least of that and v is v; beyond the box neither changes f.
    out.reshape = [low = leaf(-far_away), high = leaf(far_away)](field::NodePtr below) {
      return field::intersect({field::unite({std::move(below), low}), high});
    };
  } else {
    const char* op = settings.mode == "union" ? "union" : "difference";
    out.reshape = [own = leaf(-far_away), op](field::NodePtr below) {
      return field::combine(op, {std::move(below), own});
    };
  }
  out.report = {{"mode", settings.mode},
                {"samples", std::int64_t{frame.size.x} * frame.size.y * frame.size.z},
                {"spacing m", frame.spacing},
                {"bytes", static_cast<std::int64_t>(volume.grid.bytes())}};
  return out;
}

raster::Raster heights_of(const io::Volume& volume) {
  const ScalarGrid& grid = volume.grid;
  const volume::GridFrame& frame = grid.frame();
  const Vec3i n = frame.size;
  raster::Grid<float> columns(n.x, n.y);
  const Vec3i chunks = grid.chunks();
  parallel_for(std::int64_t{chunks.x} * chunks.y, [&](std::int64_t index) {
    const int a = static_cast<int>(index % chunks.x), b = static_cast<int>(index / chunks.x);
    std::vector<double> tops;
    Tops(grid).find(a, b, tops);
    constexpr int side = ScalarGrid::chunk_samples;
    const int width = std::min(side, n.x - a * side);
    for (std::size_t i = 0; i < tops.size(); ++i)
      columns.at(a * side + static_cast<int>(i) % width, b * side + static_cast<int>(i) / width) =
          static_cast<float>(tops[i] + volume.origin.z);
  });
  raster::Raster out;
  out.crs = volume.metadata.crs;
  const Vec3d west_south = volume.origin + frame.origin;
  out.placement = {west_south.x, west_south.y + frame.spacing * (n.y - 1), frame.spacing, frame.spacing};
  out.values = raster::Grid<float>(n.x - 1, n.y - 1);
  for (int row = 0; row < n.y - 1; ++row)
    for (int col = 0; col < n.x - 1; ++col) {
      const int y = n.y - 2 - row;
      out.values.at(col, row) = std::max(std::max(columns.at(col, y), columns.at(col + 1, y)),
                                         std::max(columns.at(col, y + 1), columns.at(col + 1, y + 1)));
    }
  return out;
}

}  // namespace tafoni::scene::impl
