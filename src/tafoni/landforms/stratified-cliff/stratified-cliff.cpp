// Cliffs whose soft beds recede: an erosion of the terrain's field by the geology's resistance with fine
// laminae, where a control says that there is a face or rock behind one.

#include <algorithm>
#include <array>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/control.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms::landform_stratified_cliff {
namespace {

using impl::Ground;
using impl::Range;
using impl::RangedRaster;

enum class Stream : std::uint64_t { laminae = 0x57 };

// Chosen by eye.
constexpr double depth_share = 0.75;  // of the terrain's amplitude: beyond it faces would break up
constexpr double least_wavelength = 8, wavelength_in_pixels = 4;  // metres
constexpr double slope_margin = 5;                // degrees over which ground turns into a face
constexpr double steepest_slope = 89.5;           // degrees; the tangent of 90 has no end
constexpr double behind_in_depths = 1.5;          // rock behind a face that may recede
constexpr double around_share = 0.25;             // of that: how far the face itself is grown
constexpr double fade_from = 0.3, fade_to = 1.3;  // fades below the ground's surface
constexpr double laminae_most = 0.6;              // of resistance, at full detail
constexpr int laminae_octaves = 3;
constexpr double flatness = 7;  // how many times longer laminae are than high

struct Params {
  double depth = 0;
  double slope = 45;
  double fade = 0;
  double detail = 0.35;
  double wavelength = 0;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("depth", &Params::depth, "m", 0, 1000,
           "How far the softest beds recede, 0 for three quarters of the terrain field's amplitude")
        .real("slope", &Params::slope, "deg", 1, 89, "Slope from which ground counts as a cliff face")
        .real("fade", &Params::fade, "m", 0, 1000,
              "Width over which erosion begins at the borders of a region and below the ground's surface "
              "behind a face, 0 for the depth")
        .real("detail", &Params::detail, "", 0, 1, "Strength of fine laminae within the beds, 0 for none")
        .real(
            "wavelength", &Params::wavelength, "m", 0, 1000,
            "Length of the laminae's unevenness, 0 for 8 m or four pixels of the terrain, whichever is more");
    return t;
  }();
  return params;
}

/// A mask grown by `radius` cells, then smoothed over as many.
raster::Grid<float> widen(const raster::Grid<float>& mask, int radius) {
  raster::Grid<float> a = mask, b(mask.width(), mask.height());
  const auto pass = [&](const auto& combine) {
    for (const bool along : {true, false}) {
      parallel_blocks(a.height(), 16, [&](int begin, int end) {
        for (int row = begin; row < end; ++row)
          for (int col = 0; col < a.width(); ++col) b.at(col, row) = combine(along, col, row);
      });
      std::swap(a, b);
    }
  };
  const auto cell = [&](bool along, int col, int row, int k) {
    return along ? a.at(std::clamp(col + k, 0, a.width() - 1), row)
                 : a.at(col, std::clamp(row + k, 0, a.height() - 1));
  };
  pass([&](bool along, int col, int row) {
    float most = 0;
    for (int k = -radius; k <= radius; ++k) most = std::max(most, cell(along, col, row, k));
    return most;
  });
  const int soft = std::max(1, radius / 2);
  pass([&](bool along, int col, int row) {
    float sum = 0;
    for (int k = -soft; k <= soft; ++k) sum += cell(along, col, row, k);
    return sum / static_cast<float>(2 * soft + 1);
  });
  return a;
}

/// Faces, and the rock behind them from `fade` metres below the ground on: that beds recede leaves the ground
/// on top and the ground before the cliff as they are.
class Faces final : public field::Function {
 public:
  Faces(RangedRaster heights, RangedRaster face, RangedRaster behind, double fade, field::FunctionPtr region,
        const Box3d& box)
      : heights_(std::move(heights)),
        face_(std::move(face)),
        behind_(std::move(behind)),
        fade_(fade),
        region_(std::move(region)),
        box_(box) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    if (region_)
      region_->values(points, out);
    else
      std::fill(out.begin(), out.end(), 1.f);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (out[i] > 0) out[i] *= box_.contains(points[i]) ? static_cast<float>(faces(points[i])) : 0.f;
  }

  Interval range(const Box3d& box) const override {
    if (!box_.overlaps(box)) return {0, 0};
    const Range behind = behind_.over(box);
    if (behind.hi <= 0) return {0, 0};
    const Interval region = region_ ? region_->range(box) : Interval{1, 1};
    if (region.hi == 0) return {0, 0};
    const Range face = face_.over(box), height = heights_.over(box);
    const double lo = mix(face.lo, behind.lo, height.lo - box.hi.z);
    const double hi = mix(face.hi, behind.hi, height.hi - box.lo.z);
    constexpr double slack = 1e-5;
    const bool within = box_.contains(box.lo) && box_.contains(box.hi);
    return {within ? std::max(0.f, static_cast<float>(lo - slack) * region.lo) : 0.f,
            std::min(1.f, static_cast<float>(hi + slack) * region.hi)};
  }

  Box3d support() const override { return box_; }

 private:
  double faces(Vec3d p) const {
    const double behind = behind_.at(p);
    return behind > 0 ? mix(face_.at(p), behind, heights_.at(p) - p.z) : 0;
  }
  double mix(double face, double behind, double under) const {
    const double least = std::min(face, behind);
    return least + (behind - least) * smoothstep(fade_from * fade_, fade_to * fade_, under);
  }

  RangedRaster heights_, face_, behind_;
  double fade_;
  field::FunctionPtr region_;
  Box3d box_;
};

/// The geology's resistance with laminae: noise drawn out along the beds.
class Laminated final : public field::Function {
 public:
  Laminated(field::FunctionPtr rho, double strength, double wavelength, Vec3d origin, std::uint64_t seed)
      : rho_(std::move(rho)), strength_(strength), wavelength_(wavelength), origin_(origin), seed_(seed) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    if (rho_)
      rho_->values(points, out);
    else
      std::fill(out.begin(), out.end(), 0.5f);
    if (strength_ <= 0) return;
    std::array<Vec3d, block> scaled;
    std::array<float, block> noise;
    for (std::size_t i = 0; i < points.size(); i += block) {
      const std::size_t n = std::min(block, points.size() - i);
      for (std::size_t k = 0; k < n; ++k) {
        const Vec3d p = points[i + k] + origin_;
        scaled[k] = {p.x / wavelength_, p.y / wavelength_, p.z * flatness / wavelength_};
      }
      fbm(std::span(scaled).first(n), laminae_octaves, seed_, std::span(noise).first(n));
      for (std::size_t k = 0; k < n; ++k)
        out[i + k] = std::clamp(out[i + k] + static_cast<float>(strength_) * 2 * (noise[k] - 0.5f), 0.f, 1.f);
    }
  }

  Interval range(const Box3d& box) const override {
    const Interval rho = rho_ ? rho_->range(box) : Interval{0.5f, 0.5f};
    const auto most = static_cast<float>(strength_) * 1.0001f;
    return {std::max(0.f, rho.lo - most), std::min(1.f, rho.hi + most)};
  }

 private:
  static constexpr std::size_t block = 128;

  field::FunctionPtr rho_;
  double strength_, wavelength_;
  Vec3d origin_;
  std::uint64_t seed_;
};

class Cliff {
 public:
  Cliff(const Site& site, const Params& p, Progress& progress) : ground_(site), p_(p), progress_(progress) {
    if (!(p_.depth > 0)) p_.depth = depth_share * site.amplitude;
    if (!(p_.fade > 0)) p_.fade = p_.depth;
    if (!(p_.wavelength > 0))
      p_.wavelength = std::max(least_wavelength, wavelength_in_pixels * ground_.pixel());
  }

  Result run() {
    Result result;
    Box3d box = ground_.box();
    double area = 0;
    if (!box.empty()) {
      const auto faces = steep(area);
      if (area > 0) result = erode(faces, box);
    }
    result.facts.count("primitives", 0)
        .area("face", area)
        .about("Area of the steep ground that was eroded, as seen from above")
        .length("depth", p_.depth)
        .about("How far the softest beds were worn back at most");
    return result;
  }

 private:
  /// How much each pixel is a face that may be eroded, and the map area of all.
  raster::Grid<float> steep(double& area) {
    const raster::Raster& heights = *ground_.site().heights;
    raster::Grid<float> faces = terrain::slope(heights, progress_);
    const double from = std::tan((p_.slope - slope_margin) * degree),
                 to = std::tan(std::min(p_.slope + slope_margin, steepest_slope) * degree);
    const double pixel = heights.placement.dx * heights.placement.dy;
    for (int row = 0; row < faces.height(); ++row)
      for (int col = 0; col < faces.width(); ++col) {
        const double slope = faces.at(col, row), s = smoothstep(from, to, slope);
        faces.at(col, row) = static_cast<float>(s);
        if (s > 0 && touches(col, row, slope)) area += s * pixel;
      }
    return faces;
  }

  /// Whether any of a face's height above a pixel may be eroded: limits of altitude may cut it anywhere.
  bool touches(int col, int row, double slope) const {
    const raster::Raster& heights = *ground_.site().heights;
    const Vec2d at = heights.placement.center(col, row);
    for (const double t : {-0.5, -0.25, 0.0, 0.25, 0.5})
      if (ground_.usable({at.x, at.y, heights.values.at(col, row) + t * slope * ground_.pixel()}))
        return true;
    return false;
  }

  Result erode(const raster::Grid<float>& faces, const Box3d& box) {
    const Site& site = ground_.site();
    const raster::Placement& at = site.heights->placement;
    const int behind = std::max(1, ceil_to(behind_in_depths * p_.depth / ground_.pixel()));
    const int around = std::max(1, floor_to(around_share * behind));
    Region limits = site.region ? *site.region : Region{};
    if (site.valid) limits.limit_mask(valid());
    const bool limited = site.region || site.valid;
    const auto control = std::make_shared<const Faces>(
        RangedRaster(site.heights->values, at), RangedRaster(widen(faces, around), at),
        RangedRaster(widen(faces, behind), at), p_.fade, limited ? as_function(&limits, p_.fade) : nullptr,
        box);
    const auto rock = std::make_shared<const Laminated>(geology::as_function(site.geology),
                                                        laminae_most * p_.detail, p_.wavelength, site.origin,
                                                        hash_combine(site.seed, Stream::laminae));
    Result result;
    result.reshape = [control, rock, depth = p_.depth](field::NodePtr tree) {
      return field::erode(std::move(tree), control, rock, depth);
    };
    result.reshaped = box;
    return result;
  }

  std::shared_ptr<const raster::Raster> valid() const {
    auto mask = std::make_shared<raster::Raster>();
    mask->placement = ground_.site().heights->placement;
    mask->values = raster::Grid<float>(ground_.site().valid->width(), ground_.site().valid->height());
    for (std::size_t i = 0; i < mask->values.size(); ++i)
      mask->values.data()[i] = ground_.site().valid->data()[i] ? 1.f : raster::no_data;
    return mask;
  }

  Ground ground_;
  Params p_;
  Progress& progress_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "stratified-cliff");
  return Cliff(site, p, progress).run();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "stratified-cliff",
                .doc = "Faces whose soft beds recede between hard ones that overhang, without any primitive",
                .source = "[Paris19 §5.3]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_stratified_cliff
