// A volume of samples as a layer: its field at its place takes the place of the tree below or is combined
// with it. A volume saturates at the band that it was sampled with, a scene at T, so values near the band are
// stretched (class Stretch).
#include <algorithm>
#include <cmath>

#include "tafoni/scene/layers/impl/site.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::scene::layer_volume {
namespace {

using volume::ScalarGrid;

struct Params {
  std::string file;
  std::string mode = "replace";
  std::vector<double> at;  ///< world position of the middle of its box; empty: where the file says
};

const std::vector<ParamInfo>& params() {
  using P = Params;
  static const std::vector<ParamInfo> infos =
      ParamTable<P>()
          .text("file", &P::file, "Path of a volume: .tvol or .vdb")
          .choice(
              "mode", &P::mode, {"replace", "insert", "union", "intersection", "carve"},
              "What becomes of the layers below: replace leaves nothing of them, insert does so within the "
              "volume's box, union adds the volume's rock, intersection keeps what is rock in both, carve "
              "removes the volume's rock")
          .numbers("at", &P::at, "m", 3, -1e9, 1e9,
                   "Where the middle of its box is put, x, y, z in the scene's CRS; none leaves it where the "
                   "file says");
  return infos;
}

/// Larger than any value of a field, so that a minimum or a maximum with it leaves the other.
constexpr float far_away = 1e4f;

/// Maps [-band, band] to [-T, T]: as it is near 0, so that the surface stays where it is, then stretched.
/// Else rock within a narrow band would be no deeper than the band, and later layers would carve into what is
/// solid. Leaves values as they are where the band is no narrower than T.
class Stretch {
  /// The part of the band below which values stay as they are: most of it, so that what lies near the surface
  /// keeps its distances.
  static constexpr float kept = 0.75f;

 public:
  Stretch(float band, float amplitude)
      : narrow_(band < amplitude),
        band_(band),
        knee_(kept * band),
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

/// A grid at its place. Beyond the frame its border goes on as far as `within`; beyond that it is `outside`.
class Placed final : public field::Function {
 public:
  Placed(const ScalarGrid& grid, Vec3d shift, Stretch stretch, const Box3d& within, float outside)
      : grid_(grid), within_(within), shift_(shift), stretch_(stretch), outside_(outside) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = beyond(points[i]) ? outside_ : stretch_(grid_.value(points[i] - shift_));
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
    if (!box.overlaps(within_)) return {outside_, outside_};
    const Interval r = grid_.range({box.lo - shift_, box.hi - shift_});
    Interval out{stretch_(r.lo), stretch_(r.hi)};
    if (!(within_.contains(box.lo) && within_.contains(box.hi)))
      out = {std::min(out.lo, outside_), std::max(out.hi, outside_)};
    return out;
  }

 private:
  bool beyond(Vec3d p) const { return !within_.contains(p); }

  ScalarGrid grid_;
  Box3d within_;
  Vec3d shift_;
  Stretch stretch_;
  float outside_;
};

/// Whether there is rock in the uppermost samples, which would go on upward without end.
bool rock_on_top(const ScalarGrid& grid) {
  const Vec3i last = grid.frame().size - Vec3i{1, 1, 1};
  std::vector<float> row(grid.frame().size.x);
  for (int j = 0; j <= last.y; ++j) {
    grid.read({{0, j, last.z}, {last.x, j, last.z}}, row.data());
    if (std::any_of(row.begin(), row.end(), [](float f) { return f > 0; })) return true;
  }
  return false;
}

landforms::Result make(const impl::LayerParts& parts, impl::Readers& readers) {
  Params p;
  assign(params(), &p, parts.words.values, "volume");
  const impl::VolumePtr file = readers.volume(parts.files.at("file"));
  const io::Volume& volume = *file;
  const volume::GridFrame& frame = volume.grid.frame();
  const Vec3d place = p.at.empty() ? volume.origin : Vec3d{p.at[0], p.at[1], p.at[2]} - frame.box().center();
  const Vec3d shift = place - parts.below.value.terrain.origin;
  const Interval range = volume.grid.range(frame.box());
  const Stretch stretch(std::max(std::abs(range.lo), std::abs(range.hi)),
                        static_cast<float>(parts.below.value.settings.amplitude));
  const Box3d box{frame.box().lo + shift, frame.box().hi + shift};
  const auto leaf = [&](const Box3d& within, float outside) {
    return field::function(std::make_shared<Placed>(volume.grid, shift, stretch, within, outside));
  };
  landforms::Result out;
  out.reshaped = box;
  out.lowest = out.reshaped.lo.z;
  if (p.mode == "replace") {
    Box3d within = Box3d::everything();
    if (rock_on_top(volume.grid)) {
      within.hi.z = box.hi.z;
      readers.progress.warn(
          "volume: its rock reaches the top of its box and is cut off there; sample it with air above");
    }
    const auto air = static_cast<float>(-parts.below.value.settings.amplitude);
    out.reshape = [own = leaf(within, air)](const field::NodePtr&) { return own; };
    out.reshaped = Box3d::everything();
  } else if (p.mode == "intersection") {
    out.reshape = [own = leaf(Box3d::everything(), 0)](field::NodePtr below) {
      return field::intersect({std::move(below), own});
    };
    out.reshaped = Box3d::everything();
  } else if (p.mode == "insert") {
    // max(f, v) is at least v, and the least of that and v is v; beyond the box neither changes f.
    out.reshape = [low = leaf(box, -far_away), high = leaf(box, far_away)](field::NodePtr below) {
      return field::intersect({field::unite({std::move(below), low}), high});
    };
  } else {
    const char* op = p.mode == "union" ? "union" : "difference";
    out.reshape = [own = leaf(box, -far_away), op](field::NodePtr below) {
      return field::combine(op, {std::move(below), own});
    };
  }
  out.facts.text("mode", p.mode)
      .about("What became of the layers below")
      .count("samples", std::int64_t{frame.size.x} * frame.size.y * frame.size.z)
      .about("Samples of the volume")
      .length("spacing", frame.spacing)
      .about("Distance between two samples")
      .count("bytes", static_cast<std::int64_t>(volume.grid.bytes()))
      .about("Memory of the volume");
  return out;
}

}  // namespace

const LayerKind& declaration() {
  static const LayerKind kind{.types = {{
                                  .about = {.name = "volume",
                                            .doc = "A sampled volume from a file",
                                            .source = "[Ju01], [Ruths01]",
                                            .params = params()},
                                  .paths = {"file"},
                                  .needs = {{"file", "the path of a .tvol or .vdb"}},
                                  .leaves_out = {"region", "mask", "altitude", "box", "points"},
                                  .because = "acts where its volume is",
                                  .make = make,
                              }}};
  return kind;
}

}  // namespace tafoni::scene::layer_volume
